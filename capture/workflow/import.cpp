// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/import.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <set>

#include "capture/workflow/failure.h"
#include "db/archive.h"
#include "processing/image/film_file.h"
#include "processing/image/sidecar_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;
constexpr const char* kDevice = "import";
constexpr std::size_t kBatchPictures = 8;

// A file of a shot, read and judged; no picture when `why_not` says something.
struct LoadedFile {
  std::string name, ext, why_not;
  bool read = true;
  Bytes bytes;
  SizePx size;
  double saturated_fraction = 0;
  fs::path path;  // empty: a frame of a film
  PictureMetadata about;
};
struct LoadedShot {
  ListedShot listed;
  std::vector<LoadedFile> files;
};
struct LoadedStep {
  ListedStep listed;
  std::vector<LoadedShot> shots;
};

void judge(LoadedFile& file) {
  if (!file.why_not.empty()) return;
  try {
    const Picture picture = decodePicture(file.bytes);
    file.size = picture.linear.size();
    file.saturated_fraction = picture.saturated_fraction;
    file.ext = extensionOf(picture.format);
    if (file.ext.empty() || picture.format == PictureFormat::kRaw)
      file.ext = fs::path(file.name).extension().string().substr(1);
    file.about =
        file.path.empty() ? readMetadata(file.bytes) : readMetadataOf(file.path, file.bytes);
  } catch (const Failure& failure) {
    file.why_not = failure.what();
  }
}

LoadedFile load(const fs::path& path) {
  LoadedFile file;
  file.name = path.filename().string();
  file.path = path;
  file.ext = path.extension().string();
  if (!file.ext.empty()) file.ext.erase(0, 1);
  try {
    file.bytes = readFile(path);
  } catch (const Failure& failure) {
    file.read = false;
    file.why_not = failure.what();
  }
  return file;
}

// Steps in order, loaded a batch at a time.
class StepStream {
 public:
  StepStream(const Listing& listing, const fs::path& source) : listing_(listing) {
    if (listing.film) film_.emplace(source);
  }
  std::optional<LoadedStep> next() {
    if (at_ == batch_.size()) fill();
    if (batch_.empty()) return std::nullopt;
    return std::move(batch_[at_++]);
  }

 private:
  void fill() {
    batch_.clear();
    at_ = 0;
    std::size_t pictures = 0;
    while (pictures < kBatchPictures) {
      std::optional<LoadedStep> step = film_ ? nextFrame() : nextListed();
      if (!step) break;
      pictures += std::max<std::size_t>(1, step->shots.size());
      batch_.push_back(std::move(*step));
    }
    std::vector<LoadedFile*> files;
    for (LoadedStep& step : batch_)
      for (LoadedShot& shot : step.shots)
        for (LoadedFile& file : shot.files) files.push_back(&file);
    tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) { judge(*files[i]); });
  }

  std::optional<LoadedStep> nextListed() {
    if (given_ == static_cast<std::int64_t>(listing_.steps.size())) return std::nullopt;
    LoadedStep step{listing_.steps[static_cast<std::size_t>(given_++)], {}};
    for (const ListedShot& shot : step.listed.shots) {
      LoadedShot loaded{shot, {}};
      for (const fs::path& path : shot.files) loaded.files.push_back(load(path));
      step.shots.push_back(std::move(loaded));
    }
    return step;
  }

  std::optional<LoadedStep> nextFrame() {
    const auto frame = film_->next();
    if (!frame) return std::nullopt;
    const UtcTime due = listing_.t0_utc + given_ * listing_.interval;
    LoadedFile file;
    file.name = "frame " + std::to_string(given_);
    file.ext = "png";
    file.bytes = encodePng(frame->view());
    LoadedStep step{{given_, due, {}}, {}};
    step.shots.push_back({{{}, listing_.lights.front().id, due}, {}});
    step.shots.back().files.push_back(std::move(file));
    ++given_;
    return step;
  }

  const Listing& listing_;
  std::optional<FilmReader> film_;
  std::vector<LoadedStep> batch_;
  std::size_t at_ = 0;
  std::int64_t given_ = 0;
};

std::string rigText(const Listing& listing) {
  std::string text = "name = \"import\"\n\n[[camera]]\nid = \"import\"\nbackend = \"import\"\n";
  for (const ListedLight& light : listing.lights) {
    text += "\n[[light]]\nid = \"" + light.id + "\"\nbackend = \"import\"\n";
    if (!light.direction) continue;
    const auto& [x, y, z] = *light.direction;
    char line[96];
    std::snprintf(line, sizeof line, "position_mm = [%.3f, %.3f, %.3f]\n", 1000 * x, 1000 * y,
                  1000 * z);
    text += line;
  }
  return text;
}

class Importer {
 public:
  Importer(const ImportOptions& options, const std::function<UtcTime()>& now, Progress& progress)
      : options_(options), now_(now), progress_(progress) {}

  ImportReport run() {
    const Listing listing = listSource(options_.listing);
    db::ArchiveOptions opening;
    opening.folder = options_.archive;
    opening.owner = options_.owner;
    db::Archive archive(opening);
    archive_ = &archive;
    begin(listing);
    progress_.begin("importing", listing.film ? listing.film_frames
                                              : static_cast<std::int64_t>(listing.steps.size()));
    StepStream stream(listing, options_.listing.source);
    while (auto step = stream.next()) {
      store(*step);
      progress_.step();
    }
    return finish(listing);
  }

 private:
  void begin(const Listing& listing) {
    report_.interval = listing.interval;
    report_.without_time = listing.without_time;
    for (const db::RunRow& run : archive_->reader().runs()) {
      if (run.plan_sha256 != listing.fingerprint || run.state == "aborted") continue;
      if (run.state == "running") {
        report_.run_id = run.id;
        report_.resumed = true;
        return;
      }
      if (!options_.again)
        throw WorkflowError(Exit::kUsage, options_.listing.source.string() +
                                              " is in the archive already, as " + run.id +
                                              "; --again imports it a second time");
    }
    db::RunRow run;
    run.id = freeId(formatUtcCompact(listing.t0_utc) + "-" + options_.specimen);
    run.specimen = options_.specimen;
    run.plan_toml = "# imported from " + options_.listing.source.filename().string() + "\n";
    run.plan_sha256 = listing.fingerprint;
    run.rig_toml = rigText(listing);
    run.boot_id = "import";
    run.t0_utc = listing.t0_utc;
    run.state = "running";
    run.interval = listing.interval;
    if (!listing.steps.empty())
      run.duration = listing.steps.back().due_utc - listing.t0_utc + listing.interval;
    if (listing.film) run.duration = listing.film_frames * listing.interval;
    report_.run_id = run.id;
    archive_->beginRun(
        run, {0, options_.specimen, options_.process, options_.description, options_.licence});
    if (listing.film)
      event("container", options_.listing.source.filename().string() + " " +
                             sha256OfFile(options_.listing.source).hex());
  }

  std::string freeId(const std::string& wanted) const {
    std::set<std::string> taken;
    for (const db::RunRow& run : archive_->reader().runs()) taken.insert(run.id);
    std::string id = wanted;
    for (int i = 2; taken.contains(id); ++i) id = wanted + "-" + std::to_string(i);
    return id;
  }

  void event(const std::string& kind, const std::string& detail) {
    archive_->addEvent({0, report_.run_id, now_(), kind, detail});
  }

  // The row of this step as an earlier, interrupted import left it.
  std::optional<db::StepRow> existing(const ListedStep& step) const {
    if (!report_.resumed) return std::nullopt;
    if (step.number) return archive_->reader().step(report_.run_id, *step.number);
    for (const db::StepRow& row : archive_->reader().steps(report_.run_id))
      if (!row.number && row.due_utc == step.due_utc) return row;
    return std::nullopt;
  }

  void store(const LoadedStep& step) {
    db::StepRow row;
    row.run_id = report_.run_id;
    row.number = step.listed.number;
    row.due_utc = step.listed.due_utc;
    row.shots_due = static_cast<int>(step.shots.size());
    if (report_.steps++ == 0) report_.first_utc = row.due_utc;
    report_.last_utc = std::max(report_.last_utc, row.due_utc);
    const auto before = existing(step.listed);
    if (before && before->decision != db::Decision::kPending) {
      row = *before;
    } else if (step.shots.empty()) {
      row.decision = db::Decision::kMissed;
      row.reason = "no picture";
      row.shots_due = 1;
      archive_->beginStep(row);
    } else {
      row.id = before ? before->id : archive_->beginStep(row);
      shoot(step, row);
      archive_->finishStep(row);
    }
    report_.captured += row.decision == db::Decision::kCaptured;
    report_.missed += row.decision == db::Decision::kMissed;
    report_.failed += row.decision == db::Decision::kFailed;
    if (before) report_.frames += row.shots_captured;
  }

  void shoot(const LoadedStep& step, db::StepRow& row) {
    const std::vector<db::ShotRow> earlier = archive_->reader().shotsOfStep(row.id);
    std::string reason;
    for (const LoadedShot& loaded : step.shots) {
      db::ShotRow shot;
      shot.step_id = row.id;
      shot.device_id = kDevice;
      shot.light_state = loaded.listed.light;
      bool done = false;
      for (const db::ShotRow& old : earlier)
        if (old.light_state == shot.light_state) {
          done = done || old.state == db::ShotState::kCaptured;
          shot.attempt = std::max(shot.attempt, old.attempt + 1);
        }
      if (!done) done = take(loaded, shot, reason);
      row.shots_captured += done;
    }
    row.decision = row.shots_captured > 0 ? db::Decision::kCaptured : db::Decision::kFailed;
    row.reason = reason;
  }

  // False when none of its files is a picture.
  bool take(const LoadedShot& loaded, db::ShotRow& shot, std::string& reason) {
    shot.began_utc = loaded.listed.utc;
    shot.began_mono = monoFromNs((loaded.listed.utc - UtcTime{}).count());
    std::vector<db::PendingFrame> frames;
    for (const LoadedFile& file : loaded.files) {
      if (!file.why_not.empty()) {
        reject(file);
        reason = file.name + ": " + file.why_not;
        continue;
      }
      const PictureMetadata& about = file.about;
      if (about.exposure) shot.exposure = *about.exposure;
      if (about.iso) shot.iso = about.iso->value;
      if (about.f_number) shot.f_number = about.f_number->value;
      frames.push_back({static_cast<int>(frames.size()), file.ext, file.bytes, file.size,
                        shot.began_utc, shot.began_mono, file.saturated_fraction});
      note(file.size);
    }
    shot.id = archive_->armShot(shot);
    if (frames.empty()) {
      shot.state = db::ShotState::kFailed;
      archive_->failShot(shot, reason);
      return false;
    }
    shot.state = db::ShotState::kCaptured;
    report_.frames +=
        static_cast<std::int64_t>(archive_->acknowledge(shot, frames, {}, now_()).size());
    return true;
  }

  void reject(const LoadedFile& file) {
    report_.rejected.push_back({file.name, file.why_not});
    const db::EventRow why{0, report_.run_id, now_(), "quarantine",
                           file.name + ": " + file.why_not};
    if (file.read)
      archive_->quarantine(file.bytes, file.ext, why);
    else
      archive_->addEvent(why);
  }

  void note(SizePx size) {
    if (sizes_.insert({size.width, size.height}).second) report_.sizes++;
    const bool first = report_.largest.width == 0;
    report_.largest.width = std::max(report_.largest.width, size.width);
    report_.largest.height = std::max(report_.largest.height, size.height);
    report_.smallest.width = first ? size.width : std::min(report_.smallest.width, size.width);
    report_.smallest.height = first ? size.height : std::min(report_.smallest.height, size.height);
  }

  ImportReport finish(const Listing& listing) {
    if (report_.frames == 0) {
      archive_->setRunState(report_.run_id, "aborted");
      const std::string why = report_.rejected.empty() ? std::string("it holds no frame")
                                                       : report_.rejected.front().file + ": " +
                                                             report_.rejected.front().why;
      throw WorkflowError(Exit::kBadData,
                          "nothing in " + options_.listing.source.string() + " was usable; " + why);
    }
    if (report_.sizes > 1)
      event("sizes", std::to_string(report_.sizes) + " sizes, " +
                         std::to_string(report_.smallest.width) + "x" +
                         std::to_string(report_.smallest.height) + " to " +
                         std::to_string(report_.largest.width) + "x" +
                         std::to_string(report_.largest.height));
    if (listing.interval == Nanoseconds{} && listing.steps.size() > 1)
      event("irregular", "the times have no common interval: no step counts as missed");
    archive_->setRunState(report_.run_id, "imported");
    return report_;
  }

  const ImportOptions& options_;
  const std::function<UtcTime()>& now_;
  Progress& progress_;
  db::Archive* archive_ = nullptr;
  ImportReport report_;
  std::set<std::pair<int, int>> sizes_;
};

}  // namespace

ImportReport importPictures(const ImportOptions& options, const std::function<UtcTime()>& now,
                            Progress& progress) {
  if (options.specimen.empty()) throw WorkflowError(Exit::kUsage, "which specimen is this?");
  return Importer(options, now, progress).run();
}

}  // namespace patina::workflow
