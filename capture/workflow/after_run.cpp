// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/after_run.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "capture/workflow/film.h"
#include "capture/workflow/run_reflectance.h"
#include "capture/workflow/stbrdf_product.h"

namespace patina::workflow {
namespace {

constexpr const char* kCommand = "after the run";
using Choice = std::tuple<std::string, std::string, int>;  // camera, light state, exposure

std::set<Choice> choicesOf(const db::ArchiveReader& reader, const std::string& run_id) {
  std::set<Choice> choices;
  reader.eachFrame(run_id, [&](const db::ArchiveReader::CapturedFrame& one) {
    const bool whole = one.step.number && one.step.decision == db::Decision::kCaptured &&
                       one.step.shots_captured >= one.step.shots_due;
    if (whole && one.shot.light_state != "off")
      choices.insert({one.shot.device_id, one.shot.light_state, one.shot.exposure_index});
  });
  return choices;
}

std::optional<db::ProductRow> madeBefore(const db::ArchiveReader& reader, const std::string& kind,
                                         const std::string& run_id, const std::string& name) {
  for (const db::ProductRow& row : reader.products(kind))
    if (row.run_id == run_id && row.command == kCommand &&
        Facts::parse(row.metadata_json).text("after").value_or("") == name &&
        std::filesystem::exists(pathOfProduct(reader.folder(), row)))
      return row;
  return std::nullopt;
}

// Cameras with a whole step under lamps, and whether they have several exposures to be merged.
std::map<std::string, bool> camerasOf(const db::ArchiveReader& reader, const std::string& run_id) {
  std::map<std::string, std::set<int>> exposures;
  for (const auto& [camera, light, exposure] : choicesOf(reader, run_id))
    exposures[camera].insert(exposure);
  std::map<std::string, bool> cameras;
  for (const auto& [camera, numbers] : exposures) cameras[camera] = numbers.size() > 1;
  return cameras;
}

RunReflectanceRequest reflectanceOf(const std::string& run_id, const std::string& camera,
                                    bool merged, const AfterOptions& options) {
  RunReflectanceRequest request;
  request.run = run_id;
  request.frames.selection.camera = camera;
  request.frames.selection.merged = merged;
  request.frames.registration = options.registration;
  if (options.place) {
    const SpecimenPlace place = options.place(camera);
    request.region = place.region;
    request.mm_per_pixel = place.mm_per_texel;
  }
  request.rig = options.lamps;
  request.bin = options.bin;
  request.command = kCommand;
  request.version = options.version;
  request.after = camera;
  return request;
}

class Finisher {
 public:
  Finisher(const std::filesystem::path& archive, const std::string& run_id,
           const AfterOptions& options, const std::function<UtcTime()>& now, Progress& progress)
      : archive_(archive), run_id_(run_id), options_(options), now_(now), progress_(progress) {}

  std::vector<AfterProduct> run() {
    const auto asked = [this](const char* step) {
      return std::find(options_.steps.begin(), options_.steps.end(), step) != options_.steps.end();
    };
    if (asked("ttf") || asked("film"))
      for (const Choice& choice : choicesOf(db::ArchiveReader(archive_), run_id_)) {
        const std::filesystem::path texture = makeTexture(choice);
        if (asked("film")) makeFilmOf(choice, texture);
      }
    if (asked("brdf") || asked("stbrdf"))
      for (const auto& [camera, merged] : camerasOf(db::ArchiveReader(archive_), run_id_)) {
        const std::string set = makeReflectance(camera, merged);
        if (asked("stbrdf")) makeAgeing(camera, set);
      }
    return std::move(products_);
  }

 private:
  static std::string nameOf(const Choice& choice) {
    const auto& [camera, light, exposure] = choice;
    return camera + " " + light + " " + std::to_string(exposure);
  }

  std::filesystem::path makeTexture(const Choice& choice) {
    const db::ArchiveReader reader(archive_);
    if (const auto row = madeBefore(reader, "ttf", run_id_, nameOf(choice))) {
      products_.push_back({"ttf", row->id, pathOfProduct(archive_, *row), false});
      return products_.back().path;
    }
    TtfRequest request;
    request.run = run_id_;
    std::tie(request.selection.camera, request.selection.light, std::ignore) = choice;
    request.selection.exposure = std::get<2>(choice);
    request.registration = options_.registration;
    if (options_.place) {
      const SpecimenPlace place = options_.place(request.selection.camera);
      request.build.region = place.region;
      request.build.mm_per_texel = place.mm_per_texel;
    }
    request.command = kCommand;
    request.after = nameOf(choice);
    request.version = options_.version;
    request.process = options_.process;
    request.seed = options_.seed;
    const TtfOutcome outcome = makeTtf(archive_, request, now_(), progress_);
    products_.push_back({"ttf", outcome.product.id, outcome.path, true});
    if (const std::string refused = refusedFrames(outcome.registration); !refused.empty())
      products_.back().warnings.push_back(nameOf(choice) + ": " + refused);
    return outcome.path;
  }

  std::string makeReflectance(const std::string& camera, bool merged) {
    const db::ArchiveReader reader(archive_);
    if (const auto row = madeBefore(reader, "brdf", run_id_, camera)) {
      products_.push_back({"brdf", row->id, pathOfProduct(archive_, *row), false});
      return row->id;
    }
    const RunReflectanceOutcome outcome =
        fitRun(archive_, reflectanceOf(run_id_, camera, merged, options_), now_(), progress_);
    products_.push_back(
        {"brdf", outcome.product->id, outcome.set / "manifest.json", true, outcome.warnings});
    return outcome.product->id;
  }

  void makeAgeing(const std::string& camera, const std::string& set) {
    const db::ArchiveReader reader(archive_);
    if (const auto row = madeBefore(reader, "stbrdf", run_id_, camera)) {
      products_.push_back({"stbrdf", row->id, pathOfProduct(archive_, *row), false});
      return;
    }
    const StbrdfOutcome outcome = fitStbrdf(
        archive_, {set, options_.degree, kCommand, options_.version, camera}, now_(), progress_);
    products_.push_back({"stbrdf", outcome.product.id, outcome.set / "manifest.json", true});
  }

  void makeFilmOf(const Choice& choice, const std::filesystem::path& texture) {
    const db::ArchiveReader reader(archive_);
    if (const auto row = madeBefore(reader, "film", run_id_, nameOf(choice))) {
      products_.push_back({"film", row->id, pathOfProduct(archive_, *row), false});
      return;
    }
    const Sequence sequence = sequenceOfTtf(texture);
    const ProductFile file =
        placeProduct(archive_, freeProductId(reader, "film", run_id_), "film.mp4", {});
    const FilmOutcome film = makeFilm(sequence, {}, file.path, progress_);
    Facts metadata;
    metadata.text("after", nameOf(choice));
    metadata.count("frames", film.frames).number("frames_per_second", film.frames_per_second);
    metadata.number("gain", film.gain);
    const Making making{kCommand, {}, options_.seed, options_.version, sequence.input_sha256s};
    recordProduct(archive_, file, "film", run_id_, making, metadata, now_());
    products_.push_back({"film", file.id, file.path, true});
  }

  const std::filesystem::path archive_;
  const std::string run_id_;
  const AfterOptions& options_;
  const std::function<UtcTime()>& now_;
  Progress& progress_;
  std::vector<AfterProduct> products_;
};

}  // namespace

std::vector<AfterProduct> finishRun(const std::filesystem::path& archive, const std::string& run_id,
                                    const AfterOptions& options,
                                    const std::function<UtcTime()>& now, Progress& progress) {
  return Finisher(archive, run_id, options, now, progress).run();
}

void feedRun(const std::filesystem::path& archive, const std::string& run_id,
             const AfterOptions& options, Progress& progress) {
  for (const auto& [camera, merged] : camerasOf(db::ArchiveReader(archive), run_id)) {
    RunReflectanceRequest request = reflectanceOf(run_id, camera, merged, options);
    request.so_far = true;
    fitRun(archive, request, {}, progress);
  }
}

}  // namespace patina::workflow
