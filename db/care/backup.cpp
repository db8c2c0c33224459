// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/backup.h"

#include <sqlite3.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "db/archive_state.h"
#include "db/care/backup_files.h"
#include "db/catalogue_exchange.h"
#include "db/errors.h"
#include "db/journal_rewrite.h"
#include "db/recovery.h"
#include "db/row_statements.h"
#include "db/schema.h"

namespace patina::db::care {
namespace {

namespace fs = std::filesystem;

fs::path plain(const fs::path& path) {
  fs::path whole = fs::weakly_canonical(fs::absolute(path)).lexically_normal();
  return whole.has_filename() ? whole : whole.parent_path();
}

bool lies(const fs::path& inner, const fs::path& outer) {
  const auto relative = inner.lexically_relative(outer);
  return !relative.empty() && *relative.begin() != "..";
}

// All pages as they are at one moment, while others write: the reading transaction holds it.
void copyDatabase(Database& from, Database& to, Progress& progress) {
  constexpr int kPagesAStep = 2048;
  from.run("BEGIN");
  from.number("SELECT count(*) FROM sqlite_schema");
  sqlite3_backup* copy = sqlite3_backup_init(to.handle(), "main", from.handle(), "main");
  if (copy == nullptr) to.fail(sqlite3_errcode(to.handle()), "copying to");
  int code = SQLITE_OK;
  try {
    while ((code = sqlite3_backup_step(copy, kPagesAStep)) == SQLITE_OK) progress.step(0);
  } catch (...) {
    sqlite3_backup_finish(copy);
    throw;
  }
  sqlite3_backup_finish(copy);
  if (code != SQLITE_DONE) to.fail(code, "copying to");
  from.run("COMMIT");
}

class Backup {
 public:
  Backup(const fs::path& archive, const fs::path& backup, const BackupOptions& options,
         Progress& progress)
      : archive_(plain(archive)), check_(options.check), progress_(progress) {
    to_.options.folder = plain(backup);
    to_.options.owner = options.owner;
    to_.options.allow_network_file_system = true;  // one writer, who only adds files
    to_.files = options.files ? options.files : &realFileOps();
  }

  BackupReport run() {
    refuseWrongPlaces();
    const auto source = openForReading(archive_ / "catalog.sqlite");
    checkVersion(*source);
    to_.prepare();
    sweepTemporaries(*to_.files, folder());
    to_.store = std::make_unique<FrameStore>(*to_.files, to_.options);
    takeSnapshot(*source);
    refuseAnotherArchive();
    countAndCheckSpace();
    copyFrames();
    copyProducts();
    copyQuarantine();
    copyJournals();
    snapshot_.reset();
    exchangeCatalogue(*to_.files, folder(), fresh());
    return std::move(report_);
  }

 private:
  const fs::path& folder() const { return to_.options.folder; }
  fs::path fresh() const { return folder() / "tmp" / "catalog.sqlite"; }
  void problem(const char* what, const fs::path& path, const std::string& detail) {
    report_.problems.push_back({what, path.string(), detail});
  }

  void refuseWrongPlaces() const {
    if (!fs::exists(archive_ / "catalog.sqlite"))
      throw ArchiveError(Exit::kBadData,
                         archive_.string() + " is no archive: it has no catalog.sqlite");
    if (folder() == archive_ || lies(folder(), archive_) || lies(archive_, folder()))
      throw ArchiveError(Exit::kUsage,
                         "an archive cannot be backed up into itself: name a folder "
                         "outside of " +
                             archive_.string() + ", best on another disk");
    std::error_code error;
    if (!fs::exists(folder(), error)) return;
    if (!fs::is_directory(folder(), error))
      throw ArchiveError(Exit::kCannotCreate, folder().string() + " is no folder");
    if (!fs::is_empty(folder(), error) && !fs::is_directory(folder() / "frames", error))
      throw ArchiveError(Exit::kCannotCreate,
                         folder().string() + " holds something else: name an empty folder");
  }

  void takeSnapshot(Database& source) {
    progress_.begin("catalogue", 0);
    snapshot_ = std::make_unique<Database>(fresh(), Database::Access::kCreate, *to_.files);
    snapshot_->run("PRAGMA synchronous=OFF");  // synced whole, before it takes its place
    copyDatabase(source, *snapshot_, progress_);
    snapshot_->run("PRAGMA journal_mode=DELETE");
    Statement whole(*snapshot_, "PRAGMA quick_check(1)");
    if (!whole.step() || whole.text(0) != "ok")
      throw ArchiveError(Exit::kBadData, "the catalogue of " + archive_.string() +
                                             " is damaged: 'patina archive rebuild' makes it anew, "
                                             "then back up");
    report_.runs = snapshot_->number("SELECT count(*) FROM run");
  }

  // Every frame the backup knows must be one of the archive's.
  void refuseAnotherArchive() {
    if (sizeOf(folder() / "catalog.sqlite") <= 0) return;
    std::int64_t foreign = 0;
    try {
      snapshot_->attach(folder() / "catalog.sqlite", "old");
      foreign = snapshot_->number(
          "SELECT count(*) FROM old.frame o WHERE NOT EXISTS (SELECT 1 FROM main.frame f WHERE "
          "f.id = o.id AND f.sha256 = o.sha256)");
      has_old_ = true;
    } catch (const ArchiveError&) {
      return;  // a damaged catalogue of the backup is about to be replaced
    }
    if (foreign == 0) return;
    snapshot_.reset();
    sweepTemporaries(*to_.files, folder());
    throw ArchiveError(Exit::kUsage,
                       folder().string() + " holds " + std::to_string(foreign) + " frames that " +
                           archive_.string() +
                           " does not know: it is the backup of another archive, or went on by "
                           "itself, or the archive lost them. Name another folder");
  }

  // Equal bytes are one file with several rows.
  template <class Each>
  void eachFrame(Each each) {
    Statement frames(*snapshot_,
                     "SELECT sha256, ext, bytes, min(id) FROM frame GROUP BY sha256, ext");
    while (frames.step())
      each(StoredName{Sha256::fromHex(frames.text(0)), std::string(frames.text(1))},
           frames.integer(2), frames.integer(3));
  }

  void countAndCheckSpace() {
    std::uint64_t needed = 0;
    eachFrame([&](const StoredName& name, std::int64_t bytes, RowId) {
      ++report_.frames;
      if (sizeOf(folder() / framePath(name.sha256, name.ext)) != bytes)
        needed += static_cast<std::uint64_t>(bytes);
    });
    Space space;
    checkDisk(to_.files->space(folder(), &space), "looking at", folder());
    if (needed > space.free_bytes)
      throw DiskFull("the backup needs " + formatBytes(needed) + ", " + folder().string() +
                     " has " + formatBytes(space.free_bytes) +
                     " free: make room or name another disk");
  }

  bool isThere(const StoredName& name, std::int64_t bytes) {
    const auto path = folder() / framePath(name.sha256, name.ext);
    if (sizeOf(path) != bytes) return false;
    if (!check_) return true;
    const Loaded there = load(*to_.files, path);
    return there.error == 0 && there.sha256 == name.sha256;
  }

  void copyFrames() {
    progress_.begin("frames", report_.frames);
    std::optional<Sha256> unsynced;  // its folder has new names
    eachFrame([&](const StoredName& name, std::int64_t bytes, RowId id) {
      progress_.step();
      if (isThere(name, bytes)) return noteLost(name, bytes, id);
      if (unsynced && unsynced->bytes[0] != name.sha256.bytes[0])
        to_.store->syncFolderOf(*std::exchange(unsynced, std::nullopt));
      if (copyFrame(name, bytes, id)) unsynced = name.sha256;
    });
    if (unsynced) to_.store->syncFolderOf(*unsynced);
  }

  // The backup has what the archive lost.
  void noteLost(const StoredName& name, std::int64_t bytes, RowId id) {
    const auto path = archive_ / framePath(name.sha256, name.ext);
    if (sizeOf(path) != bytes)
      problem(sizeOf(path) < 0 ? "missing" : "size", path,
              "frame " + std::to_string(id) + "; the backup has it: copy it back");
  }

  bool copyFrame(const StoredName& name, std::int64_t bytes, RowId id) {
    const auto path = archive_ / framePath(name.sha256, name.ext);
    const std::string frame = "frame " + std::to_string(id);
    const Loaded loaded = load(realFileOps(), path);
    if (loaded.error == ENOENT) return problem("missing", path, frame), false;
    if (loaded.error != 0)
      return problem("unreadable", path, frame + ": " + std::strerror(loaded.error)), false;
    if (loaded.sha256 != name.sha256)
      return problem("hash", path, frame + " is not what it was"), false;
    to_.store->place(to_.store->writeTemporary(loaded.bytes, name.ext), name.sha256, name.ext,
                     loaded.bytes);
    ++report_.frames_copied;
    report_.bytes_copied += static_cast<std::uint64_t>(bytes);
    return true;
  }

  void copyProducts() {
    struct Product {
      std::string id, path, sha256;
      bool known;
    };
    std::vector<Product> products;
    {
      Statement rows(*snapshot_, has_old_
                                     ? "SELECT p.id, p.path, p.sha256, EXISTS (SELECT 1 FROM "
                                       "old.product o WHERE o.id = p.id AND o.sha256 = p.sha256) "
                                       "FROM main.product p ORDER BY p.id"
                                     : "SELECT id, path, sha256, 0 FROM product ORDER BY id");
      while (rows.step())
        products.push_back({std::string(rows.text(0)), std::string(rows.text(1)),
                            std::string(rows.text(2)), rows.integer(3) != 0});
    }
    progress_.begin("products", static_cast<std::int64_t>(products.size()));
    for (const Product& p : products) {
      progress_.step();
      if (p.id.empty() || p.id.front() == '.' || p.id.find('/') != std::string::npos)
        throw ArchiveError(Exit::kBadData, "product '" + p.id + "' has no id that names a folder");
      const auto from = archive_ / "products" / p.id;
      std::vector<fs::path> inside;
      std::error_code error;
      for (const auto& entry : fs::recursive_directory_iterator(from, error))
        if (entry.is_regular_file(error)) inside.push_back(entry.path().lexically_relative(from));
      bool any = false;
      for (const auto& file : inside)
        any |= copyProductFile(p.id, file, p.known, file == p.path ? p.sha256 : std::string());
      if (any) ++report_.products_copied;
      if (!fs::path(p.path).is_absolute() && sizeOf(from / p.path) < 0 && !p.path.empty())
        problem("missing", from / p.path, "product " + p.id);
    }
  }

  bool copyProductFile(const std::string& id, const fs::path& file, bool known,
                       const std::string& sha256) {
    const auto from = archive_ / "products" / id / file, to = folder() / "products" / id / file;
    if (known && sizeOf(from) == sizeOf(to) && (!check_ || sha256.empty() || hashOf(to) == sha256))
      return false;
    const Copied copied =
        copyToTemporary(*to_.files, from, folder(), std::numeric_limits<std::int64_t>::max());
    if (!sha256.empty() && copied.sha256.hex() != sha256) {
      problem("hash", from, "product " + id + " is not what it was");
      return false;
    }
    makeFolders(to.parent_path());
    checkDisk(to_.files->renameReplace(copied.temporary, to), "renaming to", to);
    checkDisk(to_.files->syncFolder(to.parent_path()), "syncing", to.parent_path());
    report_.bytes_copied += static_cast<std::uint64_t>(copied.bytes);
    return true;
  }

  // What was set aside: nothing names it, but somebody may want to look. A file never changes
  // there.
  void copyQuarantine() {
    const auto from = archive_ / "quarantine";
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(from, error)) {
      const auto to = folder() / "quarantine" / entry.path().filename();
      if (!entry.is_regular_file(error) || sizeOf(to) == sizeOf(entry.path())) continue;
      const Copied copied = copyToTemporary(*to_.files, entry.path(), folder(),
                                            std::numeric_limits<std::int64_t>::max());
      makeFolders(to.parent_path());
      checkDisk(to_.files->renameReplace(copied.temporary, to), "renaming to", to);
      checkDisk(to_.files->syncFolder(to.parent_path()), "syncing", to.parent_path());
      ++report_.set_aside_copied;
      report_.bytes_copied += static_cast<std::uint64_t>(copied.bytes);
    }
  }

  static std::string hashOf(const fs::path& path) {
    try {
      return sha256OfFile(path).hex();
    } catch (const ProcessingError&) {
      return {};
    }
  }

  void makeFolders(const fs::path& path) {
    if (path == folder() || fs::is_directory(path)) return;
    makeFolders(path.parent_path());
    const int made = to_.files->makeFolder(path);
    if (made != -EEXIST) checkDisk(made, "making", path);
    checkDisk(to_.files->syncFolder(path.parent_path()), "syncing", path.parent_path());
  }

  // Exactly what the snapshot contains of each, so that whoever opens the backup recovers nothing.
  void copyJournals() {
    std::vector<std::pair<std::string, std::int64_t>> marks;
    {
      Statement rows(*snapshot_, "SELECT journal, bytes FROM journal_mark ORDER BY journal");
      while (rows.step()) marks.emplace_back(std::string(rows.text(0)), rows.integer(1));
    }
    progress_.begin("journals", static_cast<std::int64_t>(marks.size()));
    for (const auto& [name, bytes] : marks) {
      progress_.step();
      if (!copyJournal(name, bytes)) rewrite(name);
    }
    checkDisk(to_.files->syncFolder(folder() / "journal"), "syncing", folder() / "journal");
  }

  bool copyJournal(const std::string& name, std::int64_t bytes) {
    const auto from = journalPath(archive_, name), to = journalPath(folder(), name);
    if (sizeOf(from) < bytes) return false;
    const Copied copied = copyToTemporary(*to_.files, from, folder(), bytes);
    int bad = 0;
    const std::int64_t whole =
        scanJournal(*to_.files, copied.temporary, 0, bytes,
                    [&bad](const JournalBatch& batch) { bad += batch.bad_lines; });
    if (whole != bytes || bad > 0) return false;
    checkDisk(to_.files->renameReplace(copied.temporary, to), "renaming to", to);
    report_.bytes_copied += static_cast<std::uint64_t>(bytes);
    return true;
  }

  // The archive's own journal is damaged; the catalogue still knows all of it.
  void rewrite(const std::string& name) {
    problem("journal", journalPath(archive_, name),
            "is damaged; the backup's was written from the catalogue");
    const std::int64_t bytes = rewriteJournal(*to_.files, folder(), *snapshot_, name);
    Statement mark(*snapshot_, "UPDATE journal_mark SET bytes = ? WHERE journal = ?");
    mark.bind(1, bytes).bind(2, name).run();
  }

  fs::path archive_;
  bool check_;
  Progress& progress_;
  Archive::State to_;
  std::unique_ptr<Database> snapshot_;
  bool has_old_ = false;
  BackupReport report_;
};

}  // namespace

BackupReport backup(const fs::path& archive, const fs::path& backup, const BackupOptions& options,
                    Progress& progress) {
  return Backup(archive, backup, options, progress).run();
}

}  // namespace patina::db::care
