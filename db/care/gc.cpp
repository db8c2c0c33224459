// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/gc.h"

#include <algorithm>
#include <cerrno>
#include <map>
#include <utility>

#include "db/care/gc_marks.h"
#include "db/catalogue_write.h"
#include "db/errors.h"
#include "db/frame_store.h"
#include "db/lock.h"
#include "db/schema.h"
#include "db/trash.h"

namespace patina::db::care {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> sorted(std::vector<fs::path> paths) {
  std::ranges::sort(paths);
  return paths;
}

std::vector<fs::path> entriesOf(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) paths.push_back(entry.path());
  return sorted(std::move(paths));
}

std::vector<fs::path> filesBelow(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error))
    if (entry.is_symlink(error) || !entry.is_directory(error)) paths.push_back(entry.path());
  return sorted(std::move(paths));
}

class Sweep {
 public:
  Sweep(const fs::path& archive, const GcOptions& options, Progress& progress)
      : archive_(fs::absolute(archive).lexically_normal()),
        options_(options),
        files_(options.files ? *options.files : realFileOps()),
        progress_(progress) {
    const auto file = archive_ / "catalog.sqlite";
    if (!fs::exists(file))
      throw ArchiveError(Exit::kBadData,
                         archive.string() + " is no archive: it has no catalog.sqlite");
    if (!options_.dry_run) lock_ = takeCareLock(files_, archive_, options_.owner);
    catalogue_ = openForReading(file);
    checkVersion(*catalogue_);
    reader_ = std::make_unique<CatalogueWriter>(*catalogue_);
    old_marks_ = readMarks(files_, archive_);
  }

  GcReport run() {
    std::vector<fs::path> looked;
    if (!options_.dry_run) returnNamed();
    progress_.begin("looking for what nothing names", 5);
    for (const auto& path : strangeFrames()) consider(path);
    progress_.step();
    for (const auto& path : strangeProducts()) consider(path);
    progress_.step();
    for (const auto& path : filesBelow(archive_ / "quarantine")) consider(path);
    progress_.step();
    for (const auto& path : filesBelow(archive_ / "tmp")) consider(path);
    progress_.step();
    for (const auto& path : trashed()) consider(path);
    progress_.step();
    // Before anything moves: a death in between must not make the rest wait again.
    if (!options_.dry_run) writeMarks(files_, archive_, marks_);
    act();
    if (!options_.dry_run) writeMarks(files_, archive_, marks_);
    std::ranges::sort(report_.items, {}, &GcItem::path);
    return std::move(report_);
  }

 private:
  std::string below(const fs::path& path) const {
    return path.lexically_relative(archive_).string();
  }
  std::vector<JournalTail> tails() { return readTails(files_, archive_, *catalogue_, *reader_); }

  void returnNamed() {
    for (const auto& path : returnNamedFrames(files_, archive_, *catalogue_, tails()))
      report_.items.push_back(
          {below(path), identityOf(path).bytes, GcAction::kReturned, options_.now, options_.now});
  }

  std::vector<fs::path> strangeFrames() {
    std::vector<fs::path> strange;
    Statement known(*catalogue_, "SELECT 1 FROM frame WHERE sha256 = ? AND ext = ?");
    for (const auto& path : filesBelow(archive_ / "frames")) {
      const auto name = parseFramePath(path);
      const Reading reading(known);
      if (name) known.bind(1, name->sha256.hex()).bind(2, name->ext);
      if (!name || !known.step()) strange.push_back(path);
    }
    return strange;
  }

  bool isProduct(const std::string& id) {
    Statement known(*catalogue_, "SELECT 1 FROM product WHERE id = ?");
    known.bind(1, id);
    return known.step();
  }

  std::vector<fs::path> strangeProducts() {
    auto entries = entriesOf(archive_ / "products");
    std::erase_if(entries, [this](const fs::path& p) { return isProduct(p.filename().string()); });
    return entries;
  }

  std::vector<fs::path> trashed() {
    auto paths = filesBelow(archive_ / "trash" / "frames");
    for (const char* folder : {"products", "quarantine"})
      for (auto& path : entriesOf(archive_ / "trash" / folder)) paths.push_back(std::move(path));
    return paths;
  }

  void consider(const fs::path& path) {
    const Identity identity = identityOf(path);
    if (identity == Identity{}) return;  // gone meanwhile: a file of tmp/
    const std::string key = below(path);
    const auto old = old_marks_.find(key);
    const bool same = old != old_marks_.end() && old->second.identity == identity &&
                      old->second.since <= options_.now;
    Mark mark{identity, same ? old->second.since : options_.now};
    const bool due = options_.now - mark.since >= options_.grace;
    GcItem item{key, identity.bytes, same ? GcAction::kWaiting : GcAction::kMarked, mark.since,
                mark.since + options_.grace};
    if (due) {
      const bool last = key.starts_with("tmp/") || key.starts_with("trash/");
      item.action = last ? GcAction::kFreed : GcAction::kTrashed;
      due_.push_back(report_.items.size());
    }
    marks_[key] = mark;
    report_.items.push_back(std::move(item));
  }

  void act() {
    if (options_.dry_run || due_.empty()) return;
    progress_.begin("sweeping", static_cast<std::int64_t>(due_.size()));
    for (const std::size_t index : due_) {
      GcItem& item = report_.items[index];
      const fs::path path = archive_ / item.path;
      // Changed since we looked: somebody's after all.
      const bool ours = identityOf(path) == marks_.at(item.path).identity;
      const bool done = ours && (item.action == GcAction::kFreed ? remove(path) : toTrash(path));
      if (!done) item.action = GcAction::kWaiting;
      progress_.step();
    }
    for (const auto& folder : touched_)
      if (fs::exists(folder)) checkDisk(files_.syncFolder(folder), "syncing", folder);
    const auto back = returnNamedFrames(files_, archive_, *catalogue_, tails());
    for (const auto& path : back) forget(below(path));
  }

  // Named in the moment it was moved.
  void forget(const std::string& key) {
    for (GcItem& item : report_.items)
      if (item.path == key) item.action = GcAction::kReturned;
    marks_.erase(key);
    marks_.erase("trash/" + key);
  }

  bool toTrash(const fs::path& path) {
    const std::string key = below(path);
    const fs::path to = archive_ / "trash" / key;
    makeFolders(to.parent_path());
    const int got = files_.renameNoReplace(path, to);
    if (got == -EEXIST || got == -ENOENT) return false;  // its namesake goes first
    checkDisk(got, "moving to the trash", path);
    touched_.push_back(path.parent_path());
    touched_.push_back(to.parent_path());
    const auto name = parseFramePath(to);
    const bool frame = key.starts_with("frames/") && name;
    const bool named = frame ? isNamed(*catalogue_, tails(), *name)
                             : key.starts_with("products/") && isProduct(path.filename().string());
    if (named) {
      checkDisk(files_.renameNoReplace(to, path), "putting back", path);
      return false;
    }
    marks_.erase(key);
    marks_[below(to)] = {identityOf(to), options_.now};
    return true;
  }

  bool remove(const fs::path& path) {
    std::error_code error;
    if (fs::is_directory(path, error) && !fs::is_symlink(path, error)) {
      for (const auto& inner : filesBelow(path)) checkDisk(files_.remove(inner), "removing", inner);
      fs::remove_all(path, error);  // the empty folders that are left
      if (error) throwDiskError(error.value(), "removing", path);
    } else {
      const int got = files_.remove(path);
      if (got == -ENOENT) return false;
      checkDisk(got, "removing", path);
    }
    marks_.erase(below(path));
    touched_.push_back(path.parent_path());
    return true;
  }

  void makeFolders(const fs::path& path) {
    if (path == archive_ || fs::is_directory(path)) return;
    makeFolders(path.parent_path());
    const int made = files_.makeFolder(path);
    if (made != -EEXIST) checkDisk(made, "making", path);
  }

  fs::path archive_;
  const GcOptions& options_;
  FileOps& files_;
  Progress& progress_;
  std::unique_ptr<FileLock> lock_;
  std::shared_ptr<Database> catalogue_;
  std::unique_ptr<CatalogueWriter> reader_;
  Marks old_marks_, marks_;
  std::vector<std::size_t> due_;  // of report_.items
  std::vector<fs::path> touched_;
  GcReport report_;
};

}  // namespace

const char* name(GcAction action) {
  switch (action) {
    case GcAction::kMarked:
      return "marked";
    case GcAction::kWaiting:
      return "waiting";
    case GcAction::kTrashed:
      return "trashed";
    case GcAction::kFreed:
      return "freed";
    case GcAction::kReturned:
      return "returned";
  }
  PATINA_CHECK(!"an action of the enumeration");
}

std::int64_t GcReport::bytesOf(GcAction action) const {
  std::int64_t bytes = 0;
  for (const GcItem& item : items)
    if (item.action == action) bytes += item.bytes;
  return bytes;
}

std::int64_t GcReport::countOf(GcAction action) const {
  return std::ranges::count(items, action, &GcItem::action);
}

GcReport gc(const fs::path& archive, const GcOptions& options, Progress& progress) {
  return Sweep(archive, options, progress).run();
}

}  // namespace patina::db::care
