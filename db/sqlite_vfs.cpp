// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/sqlite_vfs.h"

#include <sqlite3.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <new>
#include <string>
#include <vector>

namespace patina::db {

struct SqliteVfs::State {
  sqlite3_vfs vfs{};
  sqlite3_vfs* base = nullptr;
  FileOps* files = nullptr;
  std::string name;
  std::atomic<int> error{0};
  bool gather = false;
  // After EIO from a sync the kernel may call lost pages clean: nothing more is promised.
  bool sync_failed = false;

  // Answers a SQLite code for -errno.
  int failed(std::int64_t answer, int code) {
    error = static_cast<int>(-answer);
    return error == ENOSPC || error == EDQUOT ? SQLITE_FULL : code;
  }
};

namespace {

constexpr std::size_t kTogether = 1 << 16;  // bytes of one write at most

// The file that SQLite's unix VFS opened, as a db::File. The owner of `inner` closes it.
class UnixFile final : public File {
 public:
  UnixFile(sqlite3_vfs* base, sqlite3_file* inner) : base_(base), inner_(inner) {}

  std::int64_t read(std::span<std::byte> into, std::int64_t offset) override {
    const int code =
        inner_->pMethods->xRead(inner_, into.data(), static_cast<int>(into.size()), offset);
    if (code == SQLITE_OK) return static_cast<std::int64_t>(into.size());
    if (code != SQLITE_IOERR_SHORT_READ) return answer(code);
    const std::int64_t bytes = size();
    if (bytes < 0) return bytes;
    return std::clamp<std::int64_t>(bytes - offset, 0, static_cast<std::int64_t>(into.size()));
  }
  std::int64_t write(std::span<const std::byte> data, std::int64_t offset) override {
    // The unix VFS takes the length modulo 128 KiB.
    data = data.first(std::min<std::size_t>(data.size(), kTogether));
    const int code =
        inner_->pMethods->xWrite(inner_, data.data(), static_cast<int>(data.size()), offset);
    return code == SQLITE_OK ? static_cast<std::int64_t>(data.size()) : answer(code);
  }
  // The unix VFS retries EINTR at every call but this one.
  int sync() override {
    int got = -EINTR;
    while (got == -EINTR) got = answer(inner_->pMethods->xSync(inner_, SQLITE_SYNC_NORMAL));
    return got;
  }
  int truncate(std::int64_t size) override {
    return answer(inner_->pMethods->xTruncate(inner_, size));
  }
  std::int64_t size() override {
    sqlite3_int64 bytes = 0;
    const int code = inner_->pMethods->xFileSize(inner_, &bytes);
    return code == SQLITE_OK ? bytes : answer(code);
  }

 private:
  int answer(int code) const {
    if (code == SQLITE_OK) return 0;
    if (code == SQLITE_FULL) return -ENOSPC;
    const int error = base_->xGetLastError(base_, 0, nullptr);
    return error > 0 ? -error : -EIO;
  }
  sqlite3_vfs* base_;
  sqlite3_file* inner_;
};

// What SQLite holds: our methods first, the unix file in the memory behind it.
struct Layer {
  sqlite3_file face;
  SqliteVfs::State* state;
  sqlite3_file* inner;
  File* file;              // owned; adopted by the FileOps
  const char* path;        // SQLite's, lives as long as the file is open
  bool folder_needs_sync;  // the file was created by us and never synced
  bool is_wal;
  std::vector<std::byte>* held;  // owned; written by SQLite, not yet by us
  std::int64_t held_at;
};

Layer* layer(sqlite3_file* file) { return reinterpret_cast<Layer*>(file); }
SqliteVfs::State* state(sqlite3_vfs* vfs) { return static_cast<SqliteVfs::State*>(vfs->pAppData); }
sqlite3_file* inner(sqlite3_file* file) { return layer(file)->inner; }

int writeThrough(Layer* self, std::span<const std::byte> left, std::int64_t offset) {
  if (self->state->sync_failed) return self->state->failed(-EIO, SQLITE_IOERR_WRITE);
  while (!left.empty()) {
    const std::int64_t got = self->file->write(left, offset);
    if (got <= 0) return self->state->failed(got < 0 ? got : -ENOSPC, SQLITE_IOERR_WRITE);
    left = left.subspan(static_cast<std::size_t>(got));
    offset += got;
  }
  return SQLITE_OK;
}

int flushHeld(Layer* self) {
  if (self->held->empty()) return SQLITE_OK;
  const int code = writeThrough(self, *self->held, self->held_at);
  self->held->clear();
  return code;
}

int layerClose(sqlite3_file* file) {
  flushHeld(layer(file));
  delete layer(file)->held;
  delete layer(file)->file;
  layer(file)->file = nullptr;
  return inner(file)->pMethods->xClose(inner(file));
}

int layerRead(sqlite3_file* file, void* into, int bytes, sqlite3_int64 offset) {
  const int flushed = flushHeld(layer(file));
  if (flushed != SQLITE_OK) return flushed;
  const auto span = std::span(static_cast<std::byte*>(into), static_cast<std::size_t>(bytes));
  const std::int64_t got = layer(file)->file->read(span, offset);
  if (got == bytes) return SQLITE_OK;
  if (got < 0) return layer(file)->state->failed(got, SQLITE_IOERR_READ);
  std::ranges::fill(span.subspan(static_cast<std::size_t>(got)), std::byte{0});
  return SQLITE_IOERR_SHORT_READ;
}

int layerWrite(sqlite3_file* file, const void* data, int bytes, sqlite3_int64 offset) {
  Layer* self = layer(file);
  const auto all = std::span(static_cast<const std::byte*>(data), static_cast<std::size_t>(bytes));
  if (!self->is_wal || !self->state->gather) return writeThrough(self, all, offset);
  const bool follows = offset == self->held_at + static_cast<std::int64_t>(self->held->size()) &&
                       self->held->size() + all.size() <= kTogether;
  if (!follows) {
    const int flushed = flushHeld(self);
    if (flushed != SQLITE_OK) return flushed;
    self->held_at = offset;
  }
  self->held->insert(self->held->end(), all.begin(), all.end());
  return SQLITE_OK;
}

int layerTruncate(sqlite3_file* file, sqlite3_int64 size) {
  const int flushed = flushHeld(layer(file));
  if (flushed != SQLITE_OK) return flushed;
  const int got = layer(file)->file->truncate(size);
  return got < 0 ? layer(file)->state->failed(got, SQLITE_IOERR_TRUNCATE) : SQLITE_OK;
}

int layerSync(sqlite3_file* file, int /*flags*/) {
  Layer* self = layer(file);
  const int flushed = flushHeld(self);
  if (flushed != SQLITE_OK) return flushed;
  if (self->state->sync_failed) return self->state->failed(-EIO, SQLITE_IOERR_FSYNC);
  const int got = self->file->sync();
  self->state->sync_failed = got < 0 && got != -ENOSPC && got != -EDQUOT;
  if (got < 0) return self->state->failed(got, SQLITE_IOERR_FSYNC);
  if (!self->folder_needs_sync) return SQLITE_OK;
  const auto folder = std::filesystem::path(self->path).parent_path();
  const int folder_got = self->state->files->syncFolder(folder);
  if (folder_got < 0) return self->state->failed(folder_got, SQLITE_IOERR_DIR_FSYNC);
  self->folder_needs_sync = false;
  return SQLITE_OK;
}

int layerSize(sqlite3_file* file, sqlite3_int64* out) {
  const int flushed = flushHeld(layer(file));
  if (flushed != SQLITE_OK) return flushed;
  const std::int64_t got = layer(file)->file->size();
  if (got < 0) return layer(file)->state->failed(got, SQLITE_IOERR_FSTAT);
  *out = got;
  return SQLITE_OK;
}

// The rest goes straight to the unix file. Version 2: shared memory, no memory-mapped reads, so
// that no write hides from the seam.
const sqlite3_io_methods kMethods = {
    2,
    layerClose,
    layerRead,
    layerWrite,
    layerTruncate,
    layerSync,
    layerSize,
    [](sqlite3_file* f, int lock) { return inner(f)->pMethods->xLock(inner(f), lock); },
    [](sqlite3_file* f, int lock) { return inner(f)->pMethods->xUnlock(inner(f), lock); },
    [](sqlite3_file* f, int* out) { return inner(f)->pMethods->xCheckReservedLock(inner(f), out); },
    [](sqlite3_file* f, int op, void* arg) {
      return inner(f)->pMethods->xFileControl(inner(f), op, arg);
    },
    [](sqlite3_file* f) { return inner(f)->pMethods->xSectorSize(inner(f)); },
    [](sqlite3_file* f) { return inner(f)->pMethods->xDeviceCharacteristics(inner(f)); },
    [](sqlite3_file* f, int page, int size, int extend, void volatile** out) {
      return inner(f)->pMethods->xShmMap(inner(f), page, size, extend, out);
    },
    [](sqlite3_file* f, int offset, int n, int flags) {
      return inner(f)->pMethods->xShmLock(inner(f), offset, n, flags);
    },
    [](sqlite3_file* f) { inner(f)->pMethods->xShmBarrier(inner(f)); },
    [](sqlite3_file* f, int remove) { return inner(f)->pMethods->xShmUnmap(inner(f), remove); },
    nullptr,
    nullptr};

constexpr int kSeamTypes = SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_WAL | SQLITE_OPEN_MAIN_JOURNAL;

int vfsOpen(sqlite3_vfs* vfs, const char* path, sqlite3_file* file, int flags, int* out_flags) {
  SqliteVfs::State* self = state(vfs);
  // Temporary files of a sort or a statement promise nothing.
  if (path == nullptr || (flags & kSeamTypes) == 0)
    return self->base->xOpen(self->base, path, file, flags, out_flags);

  auto* opened = new (file) Layer{};
  opened->state = self;
  opened->path = path;
  opened->inner = reinterpret_cast<sqlite3_file*>(opened + 1);
  int exists = 1;
  if ((flags & SQLITE_OPEN_CREATE) != 0)
    self->base->xAccess(self->base, path, SQLITE_ACCESS_EXISTS, &exists);
  if (exists == 0) {
    // Created through the seam; nobody holds a lock yet on a file that was not there.
    std::unique_ptr<File> created;
    const int got = self->files->open(path, FileOps::Mode::kCreate, &created);
    if (got < 0 && got != -EEXIST) return self->failed(got, SQLITE_CANTOPEN);
    opened->folder_needs_sync = got == 0;
  }
  const int code = self->base->xOpen(self->base, path, opened->inner, flags, out_flags);
  if (code != SQLITE_OK) {
    self->error = self->base->xGetLastError(self->base, 0, nullptr);
    return code;
  }
  auto unix_file = std::make_unique<UnixFile>(self->base, opened->inner);
  opened->is_wal = (flags & SQLITE_OPEN_WAL) != 0;
  opened->held = new std::vector<std::byte>;
  opened->file = self->files->adopt(path, std::move(unix_file)).release();
  opened->face.pMethods = &kMethods;
  return SQLITE_OK;
}

int vfsDelete(sqlite3_vfs* vfs, const char* path, int sync_folder) {
  SqliteVfs::State* self = state(vfs);
  const int got = self->files->remove(path);
  if (got == -ENOENT) return SQLITE_IOERR_DELETE_NOENT;
  if (got < 0) return self->failed(got, SQLITE_IOERR_DELETE);
  if (sync_folder == 0) return SQLITE_OK;
  const int folder_got = self->files->syncFolder(std::filesystem::path(path).parent_path());
  return folder_got < 0 ? self->failed(folder_got, SQLITE_IOERR_DIR_FSYNC) : SQLITE_OK;
}

}  // namespace

SqliteVfs::SqliteVfs(FileOps& files) : state_(std::make_unique<State>()) {
  // Sums of allocated memory, which nobody asks for, cost a lock around every allocation. Only
  // before SQLite's first use; later it is refused, and harmless.
  static const int counts_no_memory = sqlite3_config(SQLITE_CONFIG_MEMSTATUS, 0);
  static_cast<void>(counts_no_memory);
  static std::atomic<int> count{0};
  state_->base = sqlite3_vfs_find("unix");
  state_->files = &files;
  state_->name = "patina-" + std::to_string(count++);
  state_->vfs = *state_->base;
  state_->vfs.pNext = nullptr;
  state_->vfs.zName = state_->name.c_str();
  state_->vfs.szOsFile = static_cast<int>(sizeof(Layer)) + state_->base->szOsFile;
  state_->vfs.pAppData = state_.get();
  state_->vfs.xOpen = vfsOpen;
  state_->vfs.xDelete = vfsDelete;
  sqlite3_vfs_register(&state_->vfs, 0);
}

SqliteVfs::~SqliteVfs() { sqlite3_vfs_unregister(&state_->vfs); }

const char* SqliteVfs::name() const { return state_->name.c_str(); }

void SqliteVfs::gatherWrites(bool gather) { state_->gather = gather; }

int SqliteVfs::takeError() { return state_->error.exchange(0); }

}  // namespace patina::db
