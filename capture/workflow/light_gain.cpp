// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/light_gain.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numeric>
#include <vector>

#include "calibration/light/light_statistics.h"
#include "capture/workflow/calibration_record.h"
#include "capture/workflow/failure.h"
#include "db/product_writer.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKind = "light_gain";
constexpr double kDark = 0.004;      // of full scale
constexpr double kSaturated = 0.02;  // share of the region's samples

struct Measured {
  std::string sha256;
  std::array<double, 3> level{};
};

std::vector<Measured> measureAll(ArchiveFrames& frames, RectPx patch, Progress& progress) {
  std::vector<Measured> all;
  progress.begin("measuring the light", frames.count());
  while (auto frame = frames.next()) {
    const calibration::PatchLevel p = calibration::measurePatch(frame->linear.view(), patch);
    const std::string which = "frame " + std::to_string(all.size());
    if (p.saturated_fraction > kSaturated)
      throw WorkflowError(Exit::kBadData, which +
                                              " is clipped within the region: choose one that "
                                              "is darker");
    Measured one{frame->source.hex(), p.level};
    if (p.channels == 1) one.level = {p.level[0], p.level[0], p.level[0]};
    for (const double level : one.level)
      if (!(level > kDark))
        throw WorkflowError(Exit::kBadData,
                            which + " is dark within the region: choose one that is brighter");
    all.push_back(one);
    progress.step();
  }
  return all;
}

// Mean of the middle half: a single frame's level, as a median is one, has that frame's noise, and
// all gains would inherit it.
double middleOf(const std::vector<Measured>& all, std::size_t channel) {
  std::vector<double> levels;
  for (const Measured& one : all) levels.push_back(one.level[channel]);
  std::ranges::sort(levels);
  const auto quarter = static_cast<std::ptrdiff_t>((levels.size() + 1) / 4);
  return std::accumulate(levels.begin() + quarter, levels.end() - quarter, 0.0) /
         static_cast<double>(levels.size() - 2 * static_cast<std::size_t>(quarter));
}

double flickerOf(const std::vector<Measured>& all, std::size_t channel) {
  double sum = 0, squares = 0;
  for (const Measured& one : all) sum += one.level[channel];
  const double mean = sum / static_cast<double>(all.size());
  for (const Measured& one : all) squares += std::pow(one.level[channel] / mean - 1, 2);
  return std::sqrt(squares / static_cast<double>(all.size()));
}

std::string line(const std::string& sha256, const std::array<double, 3>& gain) {
  char text[64];
  std::snprintf(text, sizeof text, " %.9g %.9g %.9g", gain[0], gain[1], gain[2]);
  return sha256 + text;
}

void writeText(const fs::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text << '\n';
  if (!out.flush()) throw WorkflowError(Exit::kIo, "cannot write " + file.string());
}

void bindToFrames(const fs::path& archive, const db::ArchiveReader& reader,
                  const std::string& run_id, const db::CalibrationRow& row,
                  const LightGains& measured) {
  std::vector<db::FrameCalibrationRow> bindings;
  reader.eachFrame(run_id, [&](const db::ArchiveReader::CapturedFrame& one) {
    if (one.shot.device_id == row.device_id && one.shot.light_state == row.light_state &&
        measured.contains(one.frame.sha256.hex()))
      bindings.push_back({one.frame.id, row.id, 0, 0, true});
  });
  db::ProductWriter::bind(archive, bindings);
}

LightGains readGains(const fs::path& file) {
  std::ifstream in(file);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const Facts content = Facts::parse(text);
  LightGains gains;
  for (const auto& [key, value] : content.all()) {
    const auto* lines = std::get_if<std::vector<std::string>>(&value);
    if (key != "gains" || !lines) continue;
    for (const std::string& one : *lines) {
      std::array<float, 3> gain{};
      char sha256[65] = "";
      if (std::sscanf(one.c_str(), "%64s %f %f %f", sha256, &gain[0], &gain[1], &gain[2]) != 4 ||
          !std::all_of(gain.begin(), gain.end(), [](float g) { return g > 0; }))
        throw WorkflowError(Exit::kBadData, file.string() + ": not a gain: '" + one + "'");
      gains[sha256] = gain;
    }
  }
  return gains;
}

}  // namespace

LightGainOutcome measureLightGain(const fs::path& archive, const LightGainRequest& request,
                                  UtcTime now, Progress& progress) {
  const db::ArchiveReader reader(archive);
  const std::string run = reader.findRun(request.run).id;
  ArchiveFrames frames(reader, run, request.selection, {.light_gain = false});
  const std::vector<Measured> all = measureAll(frames, request.patch, progress);
  LightGainOutcome outcome;
  outcome.frames = static_cast<std::int64_t>(all.size());
  std::array<double, 3> baseline{};
  for (std::size_t c = 0; c < 3; ++c) {
    baseline[c] = middleOf(all, c);
    outcome.flicker[c] = flickerOf(all, c);
  }
  outcome.gain_min.fill(1e9);
  std::vector<std::string> lines;
  LightGains measured;
  for (const Measured& one : all) {
    std::array<double, 3> gain{};
    for (std::size_t c = 0; c < 3; ++c) {
      gain[c] = baseline[c] / one.level[c];
      outcome.gain_min[c] = std::min(outcome.gain_min[c], gain[c]);
      outcome.gain_max[c] = std::max(outcome.gain_max[c], gain[c]);
    }
    lines.push_back(line(one.sha256, gain));
    measured[one.sha256] = {};
  }
  const RectPx& p = request.patch;
  Facts values, options;
  values.text("run", run).count("frames", outcome.frames);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string channel(1, "rgb"[c]);
    values.number("baseline_" + channel, baseline[c])
        .number("flicker_" + channel, outcome.flicker[c]);
  }
  options
      .text("patch", std::to_string(p.x) + "," + std::to_string(p.y) + "," +
                         std::to_string(p.width) + "," + std::to_string(p.height))
      .text("camera", frames.report().camera)
      .text("light", frames.report().light);

  NewCalibration calibration;
  calibration.row.kind = kKind;
  calibration.row.device_id = frames.report().camera;
  calibration.row.light_state = frames.report().light;
  calibration.row.exposure = frames.report().exposure_time;
  calibration.row.size = frames.report().size;
  calibration.row.utc = reader.findRun(run).t0_utc;
  calibration.values = values;
  calibration.file_name = "gains.json";
  calibration.write = [&](const fs::path& file) {
    Facts content = values;
    content.embed("options", options).set("gains", lines);
    writeText(file, content.json());
  };
  calibration.run_id = run;
  calibration.making = {request.command, options, 0, request.version,
                        frames.report().input_sha256s};
  const KeptCalibration kept = keepCalibration(archive, std::move(calibration), now);
  outcome.row = kept.row;
  outcome.path = kept.path;
  bindToFrames(archive, reader, run, kept.row, measured);
  return outcome;
}

MeasuredGains lightGainsOf(const db::ArchiveReader& reader, const std::string& run_id,
                           const std::string& camera, const std::string& light) {
  const db::CalibrationRow* newest = nullptr;
  const std::vector<db::CalibrationRow> rows = reader.calibrations(kKind);
  for (const db::CalibrationRow& row : rows) {
    if (row.device_id != camera || row.light_state != light) continue;
    if (Facts::parse(row.value_json).text("run") != run_id) continue;
    if (!newest || row.id > newest->id) newest = &row;
  }
  if (!newest) return {};
  return {readGains(fileOfCalibration(reader, *newest)), newest->sha256};
}

}  // namespace patina::workflow
