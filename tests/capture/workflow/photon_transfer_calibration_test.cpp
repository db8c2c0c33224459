// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/photon_transfer_calibration.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/twin_files.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

class NoiseOf : public ::testing::Test {
 protected:
  NoiseOutcome measure(const std::filesystem::path& archive = {}) {
    Progress progress;
    return measureNoise(archive, request_, testing::now(), progress);
  }
  TempFolder folder_ = TempFolder::inMemory();
  testing::TwinFiles files_;
  NoiseRequest request_{.flats = folder_ / "flats", .darks = folder_ / "darks"};
};

TEST_F(NoiseOf, FoldersOfRawFilesIsMeasuredKeptAndReadBack) {
  files_.plant(request_.flats, {0.1, 0.1, 0.5, 0.5, 1.2, 1.2, 1.6, 1.6});
  files_.plant(request_.darks, {0, 0}, 0.02, 100);
  testing::makeRun(folder_ / "archive", {{{testing::MadeShot{}}}});
  request_.camera = "cam0";
  const NoiseOutcome outcome = measure(folder_ / "archive");
  EXPECT_EQ(outcome.transfer.flat_pairs, 4);
  EXPECT_NEAR(outcome.transfer.noise[1].electrons_per_number, 7.44, 0.3);
  ASSERT_TRUE(outcome.kept);
  EXPECT_EQ(outcome.kept->row.kind, "photon_transfer");
  EXPECT_EQ(outcome.kept->row.iso, 100);
  const calibration::NoiseModels read = readNoise(outcome.kept->path);
  EXPECT_EQ(read[2].read_noise_e, outcome.transfer.noise[2].read_noise_e);
  EXPECT_EQ(read[0].white_level, 4095);
}

TEST_F(NoiseOf, FlatsWithoutDarksAsksForThem) {
  files_.plant(request_.flats, {0.1, 0.1});
  request_.darks.clear();
  EXPECT_THROW(measure(), WorkflowError);
}

TEST_F(NoiseOf, AFileThatIsNoneIsRefused) {
  testing::writeFile(folder_ / "n.json", R"({"r.read_noise_e":3})");
  EXPECT_THROW((void)readNoise(folder_ / "n.json"), WorkflowError);
}

}  // namespace
}  // namespace patina::workflow
