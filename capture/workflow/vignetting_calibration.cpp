// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/vignetting_calibration.h"

#include <cmath>

#include "capture/workflow/failure.h"
#include "processing/image/metadata_file.h"
#include "processing/image/picture_file.h"
#include "processing/image/sha256.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kBytesMost = 1'000'000;  // of a file of values
constexpr double kSquareShare = 0.4;             // of a square that is measured, about its middle

struct Decoded {
  Image<float> linear;
  std::string sha256;
  std::optional<UtcTime> taken;
  Zoom zoom;
};
Decoded decoded(const fs::path& file) {
  const Bytes bytes = readFile(file);
  return {decodePicture(bytes).linear, sha256(bytes).hex(), readMetadata(bytes).taken_utc,
          zoomOf(bytes)};
}

void sameSize(const Decoded& picture, const fs::path& file, SizePx size) {
  if (picture.linear.size() != size)
    throw WorkflowError(Exit::kBadData, file.filename().string() +
                                            " has another size than the "
                                            "pictures before it");
}

// Mean around a place, all channels.
double levelAt(const Image<float>& picture, double x_px, double y_px, int reach_px) {
  double sum = 0;
  int count = 0;
  const int x0 = static_cast<int>(std::lround(x_px)), y0 = static_cast<int>(std::lround(y_px));
  for (int y = y0 - reach_px; y <= y0 + reach_px; ++y)
    for (int x = x0 - reach_px; x <= x0 + reach_px; ++x) {
      if (x < 0 || y < 0 || x >= picture.width() || y >= picture.height()) return 0;
      for (int c = 0; c < picture.channels(); ++c, ++count) sum += picture.at(x, y, c);
    }
  return sum / count;
}

// The middles of white squares: where four corners of the grid surround one that is bright. Which
// squares are white is asked of the picture, since a board may be seen turned by half a turn.
void addSamples(const calibration::BoardSight& sight, const calibration::BoardSpec& board,
                const Image<float>& picture, std::vector<calibration::SurfaceSample>& samples) {
  const int reach = std::max(1, static_cast<int>(sight.spacing_px * kSquareShare / 2));
  for (int parity = 0; parity < 2; ++parity) {
    std::vector<calibration::SurfaceSample> of_parity;
    double sum = 0;
    for (int row = 0; row + 1 < board.rows; ++row)
      for (int column = 0; column + 1 < board.columns; ++column) {
        if ((row + column) % 2 != parity) continue;
        double x = 0, y = 0;
        for (const int corner :
             {row * board.columns + column, row * board.columns + column + 1,
              (row + 1) * board.columns + column, (row + 1) * board.columns + column + 1}) {
          x += sight.seen_px[static_cast<std::size_t>(corner)].x / 4;
          y += sight.seen_px[static_cast<std::size_t>(corner)].y / 4;
        }
        const double level = levelAt(picture, x, y, reach);
        sum += level;
        of_parity.push_back(
            {row * board.columns + column, calibration::radiusAt(picture.size(), x, y), level});
      }
    const double mean = sum / static_cast<double>(of_parity.size());
    const double all = levelAt(picture, sight.seen_px.front().x, sight.seen_px.front().y, reach);
    if (mean < all) continue;  // around a corner half is white
    samples.insert(samples.end(), of_parity.begin(), of_parity.end());
  }
}

}  // namespace

VignettingCalibration makeVignetting(const VignettingRequest& request, UtcTime now,
                                     Progress& progress) {
  const std::vector<fs::path> files = picturesNamed(request.sources);
  VignettingCalibration made;
  made.taken = now;
  made.pictures = static_cast<int>(files.size());
  std::vector<calibration::SurfaceSample> samples;
  Image<float> sum;
  CommonZoom common;
  progress.begin("pictures", made.pictures);
  for (const fs::path& file : files) {
    const Decoded picture = decoded(file);
    if (made.size == SizePx{}) made.size = picture.linear.size();
    sameSize(picture, file, made.size);
    common.add(picture.zoom, file.filename().string());
    made.input_sha256s.push_back(picture.sha256);
    made.taken = picture.taken.value_or(made.taken);
    if (request.board) {
      const auto sight =
          findBoard(calibration::greyOf(picture.linear.view()).view(), *request.board);
      if (sight) addSamples(*sight, *request.board, picture.linear, samples);
    } else if (sum.empty()) {
      sum = picture.linear;
    } else {
      for (std::size_t i = 0; i < sum.texels().size(); ++i)
        sum.texels()[i] += picture.linear.texels()[i];
    }
    progress.step();
  }
  made.zoom = common.zoom();
  if (request.board) {
    made.fit = vignettingOfShots(samples, request.options);
    return made;
  }
  for (float& v : sum.texels()) v /= static_cast<float>(made.pictures);
  made.fit = vignettingOfFlat(sum.view(), request.options, progress);
  return made;
}

Facts factsOf(const VignettingCalibration& calibration) {
  const calibration::VignettingReport& report = calibration.fit.report;
  Facts facts;
  facts.text("kind", "vignetting")
      .count("width_px", calibration.size.width)
      .count("height_px", calibration.size.height)
      .number("a1", calibration.fit.vignetting.a1)
      .number("a2", calibration.fit.vignetting.a2)
      .number("a3", calibration.fit.vignetting.a3)
      .number("corner", report.corner)
      .number("rms", report.rms)
      .number("slope", report.slope)
      .number("radius_covered", report.radius_covered)
      .count("samples", report.samples)
      .count("left_out", report.left_out)
      .count("pictures", calibration.pictures);
  addZoom(facts, calibration.zoom);
  return facts;
}

calibration::Vignetting readVignetting(const fs::path& file) {
  const Bytes bytes = readFile(file, kBytesMost);
  const Facts facts =
      Facts::parse(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const auto a1 = facts.number("a1"), a2 = facts.number("a2"), a3 = facts.number("a3");
  if (!a1 || !a2 || !a3)
    throw WorkflowError(Exit::kBadData, file.string() +
                                            " has no numbers a1, a2 and a3 of a "
                                            "vignetting");
  return {*a1, *a2, *a3};
}

KeptCalibration keepVignetting(const fs::path& archive, const VignettingCalibration& calibration,
                               const VignettingRequest& request, const std::string& camera,
                               UtcTime now) {
  NewCalibration kept;
  kept.row.kind = "vignetting";
  kept.row.device_id = camera;
  kept.row.size = calibration.size;
  kept.row.utc = calibration.taken;
  kept.values = factsOf(calibration);
  kept.file_name = "vignetting.json";
  const std::string text = kept.values.json() + "\n";
  kept.write = [&text](const fs::path& file) { writeFileAtomically(file, text); };
  Facts options;
  options.text("kind", "vignetting").text("camera", camera).count("terms", request.options.terms);
  kept.making = {request.command, options, 0, request.version, calibration.input_sha256s};
  return keepCalibration(archive, std::move(kept), now);
}

}  // namespace patina::workflow
