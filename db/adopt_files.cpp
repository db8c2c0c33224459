// SPDX-License-Identifier: GPL-3.0-or-later
// Rows out of files, when nothing else is left that tells of them.
#include <sys/stat.h>

#include <algorithm>
#include <tuple>

#include "db/archive_state.h"
#include "db/errors.h"
#include "db/recovery.h"
#include "processing/image/metadata_file.h"

namespace patina::db {
namespace {

namespace fs = std::filesystem;
using How = Change::How;

constexpr const char* kUnknown = "unknown";

UtcTime changedAt(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return {};
  return utcFromNs(status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec);
}

struct Found {
  FrameRow frame;
  PictureMetadata says;
  std::string camera;
};

// Nothing when the file is not what its name says: it is no whole frame.
std::optional<Found> look(const fs::path& path, const StoredName& name) {
  Found found;
  try {
    const Bytes bytes = readFile(path);
    if (sha256(bytes) != name.sha256) return std::nullopt;
    found.frame.bytes = static_cast<std::int64_t>(bytes.size());
    found.says = readMetadata(bytes);
    found.frame.size = readPictureHeader(bytes).size;
  } catch (const ProcessingError&) {
    if (found.frame.bytes == 0) return std::nullopt;  // else whole, but of no format we read
  }
  found.frame.sha256 = name.sha256;
  found.frame.ext = name.ext;
  found.frame.acked_utc = changedAt(path);
  found.frame.utc = found.says.taken_utc.value_or(found.frame.acked_utc);
  found.camera = found.says.camera.empty() ? kUnknown : found.says.camera;
  return found;
}

std::vector<Found> unnamedFrames(Archive::State& s, Progress& progress) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(s.options.folder / "frames", error))
    if (entry.is_regular_file(error)) files.push_back(entry.path());
  progress.begin("frames without a row", static_cast<std::int64_t>(files.size()));
  std::vector<Found> frames;
  Statement known(*s.database, "SELECT 1 FROM frame WHERE sha256 = ? AND ext = ?");
  for (const auto& path : files) {
    progress.step();
    const auto name = parseFramePath(path);
    if (!name) continue;
    const Reading reading(known);
    known.bind(1, name->sha256.hex()).bind(2, name->ext);
    if (known.step()) continue;
    if (auto found = look(path, *name)) frames.push_back(std::move(*found));
  }
  std::ranges::sort(frames, {}, [](const Found& f) {
    return std::tuple(f.frame.utc, f.camera, f.frame.ext, f.frame.sha256);
  });
  return frames;
}

// A raw file and the JPEG beside it: one shot.
bool sameShot(const Found& a, const Found& b) {
  return a.says.taken_utc && a.says.taken_utc == b.says.taken_utc && a.camera == b.camera &&
         a.frame.ext != b.frame.ext;
}

std::string freeRunId(Database& database, UtcTime first) {
  const std::string base = formatUtcCompact(first) + "-recovered";
  std::string id = base;
  for (int n = 2;; ++n) {
    Statement taken(database, "SELECT 1 FROM run WHERE id = ?");
    taken.bind(1, id);
    if (!taken.step()) return id;
    id = base + "-" + std::to_string(n);
  }
}

std::string beginRecoveredRun(Archive::State& s, const std::vector<Found>& frames) {
  RunRow run;
  run.id = freeRunId(*s.database, frames.front().frame.utc);
  run.t0_utc = frames.front().frame.utc;
  run.duration = frames.back().frame.utc - frames.front().frame.utc;
  run.seed = 0;
  run.state = "recovered";
  run.rig = kUnknown;
  s.beginRun(run, {0, kUnknown, "", "frames whose rows were lost", ""});
  for (const Found& f : frames) s.ensureDevice(f.camera, "camera");
  return run.id;
}

void addShot(Archive::State& s, Change& change, const std::string& run_id, std::int64_t number,
             std::span<Found> files) {
  const Found& first = files.front();
  StepRow step;
  step.id = s.next.step++;
  step.run_id = run_id;
  step.number = number;
  step.due_utc = first.frame.utc;
  step.decision = Decision::kCaptured;
  step.reason = "from the file alone";
  step.shots_due = step.shots_captured = 1;
  change.add(How::kInsert, step);
  ShotRow shot;
  shot.id = s.next.shot++;
  shot.step_id = step.id;
  shot.device_id = first.camera;
  shot.light_state = kUnknown;
  shot.exposure = first.says.exposure.value_or(Nanoseconds{0});
  shot.iso = first.says.iso ? first.says.iso->value : 0;
  shot.f_number = first.says.f_number ? first.says.f_number->value : 0;
  shot.began_utc = first.frame.utc;
  shot.state = ShotState::kCaptured;
  change.add(How::kInsert, shot);
  int file_index = 0;
  for (Found& f : files) {
    f.frame.id = s.next.frame++;
    f.frame.shot_id = shot.id;
    f.frame.file_index = file_index++;
    change.add(How::kInsert, FrameRecord{f.frame, run_id});
    ++s.report.frames_from_files;
    if (!f.says.taken_utc) ++s.report.frames_dated_by_file;
  }
}

void adoptFrames(Archive::State& s, Progress& progress) {
  auto frames = unnamedFrames(s, progress);
  if (frames.empty()) return;
  const std::string run_id = beginRecoveredRun(s, frames);
  constexpr int kShotsACommit = 1000;
  Change change;
  std::int64_t number = 0;
  for (auto from = frames.begin(); from != frames.end();) {
    auto to = std::next(from);
    while (to != frames.end() && sameShot(*from, *to)) ++to;
    addShot(s, change, run_id, number++, std::span(from, to));
    from = to;
    if (number % kShotsACommit != 0 && from != frames.end()) continue;
    s.commit(run_id, change);
    change = {};
  }
  s.report.recovered_run = run_id;
}

// Its folder says only that it is one; without a row the next sweep would take it.
void adoptProducts(Archive::State& s) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(s.options.folder / "products", error)) {
    ProductRow row;
    row.id = entry.path().filename().string();
    Statement known(*s.database, "SELECT 1 FROM product WHERE id = ?");
    known.bind(1, row.id);
    if (!entry.is_directory(error) || known.step()) continue;
    fs::path main;
    for (const auto& file : fs::recursive_directory_iterator(entry.path(), error))
      if (file.is_regular_file(error) && (main.empty() || file.file_size() > fs::file_size(main)))
        main = file.path();
    if (main.empty()) continue;
    row.kind = "recovered";
    row.path = main.lexically_relative(entry.path()).string();
    row.sha256 = sha256OfFile(main).hex();
    row.created_utc = changedAt(main);
    row.options_json = row.metadata_json = "{}";
    commitShared(*s.database, *s.writer, s.journalOf({}), *s.files, s.options.folder,
                 [&](Change& change, CatalogueWriter&) { change.add(How::kUpsert, row); });
    ++s.report.products_from_files;
  }
}

}  // namespace

void adoptFiles(Archive::State& s, Progress& progress) {
  adoptFrames(s, progress);
  adoptProducts(s);
}

}  // namespace patina::db
