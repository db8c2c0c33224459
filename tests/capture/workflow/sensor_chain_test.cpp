// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/sensor_chain.h"

#include <gmock/gmock.h>

#include <cmath>

#include "capture/workflow/defects_calibration.h"
#include "capture/workflow/failure.h"
#include "capture/workflow/master.h"
#include "capture/workflow/photon_transfer_calibration.h"
#include "tests/capture/workflow/twin_files.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;
using testing::TwinFiles;

// An archive with masters of the twin's sensor, and a frame that is no row of any run.
class SensorChainOf : public ::testing::Test {
 protected:
  SensorChainOf() { testing::makeRun(archive_, {{{testing::MadeShot{}}}}); }
  void make(const std::string& kind, double level, double exposure_s = 0.02) {
    const std::filesystem::path folder = folder_ / (kind + std::to_string(++made_));
    files_.plant(folder, std::vector<double>(8, level), exposure_s, 100ull * made_);
    MasterRequest request;
    request.kind = kind;
    request.folder = folder;
    request.camera = "cam0";
    Progress progress;
    makeMaster(archive_, request, testing::now(), progress);
  }
  calibration::CalibrationKey key() const {
    calibration::CalibrationKey k;
    k.device_id = "cam0";
    k.exposure = std::chrono::milliseconds(20);
    k.iso = 100;
    k.size = {128, 96};
    k.utc = testing::now();
    return k;
  }
  // Of one frame of 20 ms at the level.
  Image<float> corrected(double level, const calibration::CalibrationKey& of, bool stale = false) {
    const db::ArchiveReader reader(archive_);
    const Bytes file = files_.dng(level, 0.02, 9000);
    SensorChain chain(reader, file, stale);
    const std::size_t bound = chain.bind(of, 1);
    chain.prepare();
    report_ = chain.report();
    bindings_ = chain.bindings();
    noise_ = chain.noise();
    return chain.apply(bound, file, {1, 1, 1});
  }
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
  TwinFiles files_;
  unsigned made_ = 0;
  SensorChain::Report report_;
  std::vector<db::FrameCalibrationRow> bindings_;
  std::optional<calibration::NoiseModels> noise_;
};

double spread(const Image<float>& image) {
  double sum = 0, squares = 0, n = 0;
  for (int y = 4; y < image.height() - 4; ++y)
    for (int x = 4; x < image.width() - 4; ++x) {
      sum += image.at(x, y, 1);
      squares += std::pow(image.at(x, y, 1), 2);
      n += 1;
    }
  return std::sqrt(squares / n - std::pow(sum / n, 2)) / (sum / n);
}

TEST_F(SensorChainOf, ARawFrameTakesDarkDefectsAndFlatInTheMosaic) {
  make("dark", 0);
  make("flat", 1);
  makeDefects(archive_, {.camera = "cam0"}, testing::now());
  const Image<float> light = corrected(0.8, key());
  EXPECT_EQ(light.channels(), 3);
  EXPECT_EQ(report_.used.size(), 3u);
  EXPECT_EQ(bindings_.size(), 3u);
  EXPECT_TRUE(report_.left.empty());
  EXPECT_LT(spread(light), 0.012);  // vignetting and the spread of pixels are gone, shots remain
}

TEST_F(SensorChainOf, ADarkOfAnotherTemperatureIsRefusedWithWhatToShoot) {
  make("dark", 0);
  calibration::CalibrationKey warm = key();
  warm.temperature_c = 32;
  corrected(0.8, warm);
  EXPECT_TRUE(report_.used.empty());
  ASSERT_EQ(report_.left.size(), 1u);
  EXPECT_THAT(report_.left[0],
              ::testing::AllOf(::testing::HasSubstr("12.0 K away"),
                               ::testing::HasSubstr("shoot 16 darks at 1/50, ISO 100, within 5 K "
                                                    "of 32 C")));
  corrected(0.8, warm, true);
  ASSERT_EQ(bindings_.size(), 1u);
  EXPECT_FALSE(bindings_[0].within_tolerance);
  EXPECT_EQ(bindings_[0].distance_temperature_k, 12);
}

TEST_F(SensorChainOf, AFlatOfAnotherExposureIsRefusedWithWhatToShoot) {
  make("flat", 0.5, 0.04);
  corrected(0.8, key());
  ASSERT_EQ(report_.left.size(), 1u);
  EXPECT_THAT(report_.left[0], ::testing::AllOf(::testing::HasSubstr("exposed for 1/25, not 1/50"),
                                                ::testing::HasSubstr("dim the light")));
}

TEST_F(SensorChainOf, TheNewestOfEqualOnesIsTaken) {
  make("dark", 0);
  make("dark", 0);
  corrected(0.8, key());
  ASSERT_EQ(report_.used.size(), 1u);
  EXPECT_THAT(report_.used[0], ::testing::StartsWith("dark 2: "));
}

TEST_F(SensorChainOf, ThePhotonTransferGivesTheNoiseOfTheFrames) {
  files_.plant(folder_ / "flats", {0.1, 0.1, 0.5, 0.5, 1.2, 1.2});
  files_.plant(folder_ / "darks", {0, 0}, 0.02, 50);
  Progress progress;
  measureNoise(archive_, {.flats = folder_ / "flats", .darks = folder_ / "darks", .camera = "cam0"},
               testing::now(), progress);
  corrected(0.8, key());
  ASSERT_TRUE(noise_);
  EXPECT_NEAR((*noise_)[1].electrons_per_number, 7.44, 0.4);
  EXPECT_EQ(bindings_.size(), 1u);
}

TEST_F(SensorChainOf, ExposuresMergedHaveLessNoiseThanTheShortestAndItsScale) {
  make("dark", 0, 0.005);
  make("dark", 0, 0.02);
  make("flat", 4, 0.005);
  files_.plant(folder_ / "flats", {0.1, 0.1, 0.5, 0.5, 1.2, 1.2});
  files_.plant(folder_ / "darks", {0, 0}, 0.02, 50);
  Progress progress;
  measureNoise(archive_, {.flats = folder_ / "flats", .darks = folder_ / "darks", .camera = "cam0"},
               testing::now(), progress);
  const db::ArchiveReader reader(archive_);
  const Bytes brief = files_.dng(0.5, 0.005, 9000), longer = files_.dng(0.5, 0.02, 9001);
  SensorChain chain(reader, brief, true);  // the flat is of the shorter exposure
  calibration::CalibrationKey of_brief = key();
  of_brief.exposure = std::chrono::milliseconds(5);
  const std::size_t first = chain.bind(of_brief, 1), second = chain.bind(key(), 2);
  chain.prepareToMerge();
  const SensorChain::Merged merged = chain.merge(std::vector<SensorChain::Exposure>{
      {first, brief, {1, 1, 1}, 0.005}, {second, longer, {1, 1, 1}, 0.02}});
  SensorChain alone(reader, brief, true);
  const std::size_t bound = alone.bind(of_brief, 1);
  alone.prepare();
  const Image<float> single = alone.apply(bound, brief, {1, 1, 1});
  EXPECT_NEAR(merged.disagreement, 1, 0.1);
  EXPECT_LT(spread(merged.light), 0.55 * spread(single)) << "of five times the light: 0.45";
  double sum = 0, of_single = 0;
  for (std::size_t i = 0; i < single.texels().size(); ++i) {
    sum += merged.light.texels()[i];
    of_single += single.texels()[i];
  }
  EXPECT_NEAR(sum / of_single, 1, 0.003);
  EXPECT_EQ(merged.saturated, 0);
}

TEST_F(SensorChainOf, AMasterOfPicturesInColourDoesNotServeTheMosaic) {
  for (int i = 0; i < 3; ++i)
    testing::plantPng(folder_ / ("c" + std::to_string(i) + ".png"), {128, 96}, 20);
  MasterRequest request;
  request.kind = "dark";
  request.folder = folder_.path();
  request.camera = "cam0";
  request.exposure = std::chrono::milliseconds(20);
  request.iso = 100;
  Progress progress;
  makeMaster(archive_, request, testing::now(), progress);
  corrected(0.8, key());
  ASSERT_EQ(report_.left.size(), 1u);
  EXPECT_THAT(report_.left[0], ::testing::HasSubstr("8 bits, not 12"));
}

}  // namespace
}  // namespace patina::workflow
