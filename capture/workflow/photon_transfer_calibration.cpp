// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/photon_transfer_calibration.h"

#include <algorithm>
#include <bit>
#include <functional>
#include <memory>

#include "capture/workflow/failure.h"
#include "capture/workflow/import_listing.h"
#include "capture/workflow/master_pictures.h"
#include "processing/image/picture_file.h"
#include "processing/image/sha256.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;
constexpr const char* kColours = "rgb";

// Raw files one after the other, and what they have in common.
struct Shots {
  std::vector<std::function<Bytes()>> files;
  std::vector<std::string> sha256s;
};

struct Common {
  std::optional<double> iso;
  SizePx size;
  int bits = 0;
  UtcTime utc;
};

Shots shotsOfFolder(const fs::path& folder) {
  Shots shots;
  for (const fs::path& file : picturesIn(folder)) {
    shots.files.push_back([file] { return readFile(file); });
    shots.sha256s.push_back(sha256OfFile(file).hex());
  }
  return shots;
}

Shots shotsOfRun(const db::ArchiveReader& reader, const NoiseRequest& request,
                 const std::string& light, std::string& camera) {
  struct One {
    db::FrameRow frame;
    int exposure = 0;
  };
  std::vector<One> chosen;
  reader.eachFrame(reader.findRun(request.run).id, [&](const auto& one) {
    if (one.frame.file_index != 0 || one.shot.light_state != light) return;
    if (!request.camera.empty() && one.shot.device_id != request.camera) return;
    if (!camera.empty() && camera != one.shot.device_id)
      throw WorkflowError(Exit::kUsage, "the run has several cameras: give --camera ID");
    camera = one.shot.device_id;
    chosen.push_back({one.frame, one.shot.exposure_index});
  });
  std::ranges::stable_sort(chosen, {}, &One::exposure);
  Shots shots;
  for (const One& one : chosen) {
    shots.files.push_back([&reader, frame = one.frame] { return reader.read(frame); });
    shots.sha256s.push_back(one.frame.sha256.hex());
  }
  return shots;
}

RawMosaic decode(const Bytes& file, Common& common) {
  RawMosaic raw = decodeRaw(file);
  if (raw.iso) {
    if (common.iso && *common.iso != raw.iso->value)
      throw WorkflowError(Exit::kBadData, "the pictures have several ISO values: gain is of one");
    common.iso = raw.iso->value;
  }
  common.size = raw.samples.size();
  common.bits = std::bit_width(static_cast<unsigned>(raw.white_level));
  if (raw.taken_utc) common.utc = *raw.taken_utc;
  return raw;
}

// Two files of one exposure; one that is left over at a change of exposure is passed by.
calibration::PairSource pairsOf(const Shots& shots, Common& common) {
  return [&shots, &common, next = std::size_t{0}]() mutable -> std::optional<calibration::RawPair> {
    while (next + 1 < shots.files.size()) {
      RawMosaic first = decode(shots.files[next](), common);
      RawMosaic second = decode(shots.files[next + 1](), common);
      if (first.exposure == second.exposure) {
        next += 2;
        return calibration::RawPair{std::move(first), std::move(second)};
      }
      ++next;
    }
    return std::nullopt;
  };
}

Facts factsOf(const calibration::NoiseModels& noise) {
  Facts facts;
  for (std::size_t c = 0; c < 3; ++c) {
    const calibration::NoiseModel& model = noise[c];
    Facts one;
    one.number("electrons_per_number", model.electrons_per_number)
        .number("read_noise_e", model.read_noise_e)
        .number("full_well_e", model.full_well_e)
        .number("black_level", model.black_level)
        .number("white_level", model.white_level);
    facts.embed(std::string(1, kColours[c]), one);
  }
  return facts;
}

}  // namespace

void writeNoise(const fs::path& file, const calibration::NoiseModels& noise) {
  writeFileAtomically(file, factsOf(noise).json() + "\n");
}

calibration::NoiseModels readNoise(const fs::path& file) {
  const Bytes bytes = readFile(file, 1 << 20);
  const Facts facts =
      Facts::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  calibration::NoiseModels noise;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto value = [&](const char* name) {
      const auto number = facts.number(std::string(1, kColours[c]) + "." + name);
      if (!number)
        throw WorkflowError(Exit::kBadData, file.string() + " is no noise model: it lacks " + name);
      return *number;
    };
    noise[c] = {value("electrons_per_number"), value("read_noise_e"), value("full_well_e"),
                value("black_level"), value("white_level")};
    if (!(noise[c].electrons_per_number > 0) || !(noise[c].range() > 0))
      throw WorkflowError(Exit::kBadData, file.string() + " is no noise model: no gain, no range");
  }
  return noise;
}

NoiseOutcome measureNoise(const fs::path& archive, const NoiseRequest& request, UtcTime now,
                          Progress& progress) {
  std::optional<db::ArchiveReader> reader;
  if (!archive.empty()) reader.emplace(archive);
  std::string camera = request.camera;
  Common common;
  common.utc = now;
  if (request.flats.empty() && !reader)
    throw WorkflowError(Exit::kUsage, "a run is in an archive: give --archive DIR");
  if (!request.flats.empty() && request.darks.empty())
    throw WorkflowError(Exit::kUsage, "give --darks FOLDER: a pair shot with the lens closed");
  const Shots flats = request.flats.empty() ? shotsOfRun(*reader, request, request.light, camera)
                                            : shotsOfFolder(request.flats);
  const Shots darks = request.flats.empty() ? shotsOfRun(*reader, request, "off", camera)
                                            : shotsOfFolder(request.darks);
  NoiseOutcome outcome;
  outcome.transfer = calibration::measurePhotonTransfer(pairsOf(darks, common),
                                                        pairsOf(flats, common), {}, progress);
  if (!reader) return outcome;
  if (camera.empty())
    throw WorkflowError(Exit::kUsage, "of which camera are these? Give --camera ID");
  NewCalibration calibration;
  calibration.row.kind = "photon_transfer";
  calibration.row.device_id = camera;
  calibration.row.iso = request.iso.value_or(common.iso.value_or(0));
  calibration.row.size = common.size;
  calibration.row.utc = common.utc;
  calibration.values = factsOf(outcome.transfer.noise);
  calibration.values.count("bits", common.bits);
  calibration.file_name = "noise.json";
  calibration.write = [&](const fs::path& file) { writeNoise(file, outcome.transfer.noise); };
  if (!request.run.empty()) calibration.run_id = reader->findRun(request.run).id;
  std::vector<std::string> inputs = flats.sha256s;
  inputs.insert(inputs.end(), darks.sha256s.begin(), darks.sha256s.end());
  Facts options;
  options.text("camera", camera);
  calibration.making = {request.command, options, 0, request.version, std::move(inputs)};
  outcome.kept = keepCalibration(archive, std::move(calibration), now);
  return outcome;
}

}  // namespace patina::workflow
