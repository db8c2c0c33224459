// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/recall.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/picture_file.h"
#include "tests/support/temp_folder.h"

namespace patina::capture {
namespace {

constexpr SizePx kSize{64, 48};
const UtcTime kBegin = parseUtc("2024-05-01");

// A run of steps under key, off and key again; every picture of its own level.
class Recall : public ::testing::Test {
 protected:
  Recall() {
    db::ArchiveOptions options;
    options.folder = folder_.path();
    db::Archive archive(options);
    db::RunRow run;
    run.id = "run";
    run.specimen = "moss";
    run.t0_utc = kBegin;
    run.interval = std::chrono::minutes(10);
    archive.beginRun(run, {0, "moss", "", "", ""});
    for (int k = 0; k < 12; ++k) {
      db::StepRow step;
      step.run_id = run.id;
      step.number = k;
      step.due_utc = kBegin + k * run.interval;
      step.shots_due = 2;
      step.id = archive.beginStep(step);
      for (const char* light : {"key", "off"}) shoot(archive, step, light, 100 + k);
      step.shots_captured = 2;
      step.decision = db::Decision::kCaptured;
      archive.finishStep(step);
    }
  }
  void shoot(db::Archive& archive, const db::StepRow& step, const std::string& light, int level) {
    db::ShotRow shot;
    shot.step_id = step.id;
    shot.device_id = "cam0";
    shot.light_state = light;
    shot.began_utc = step.due_utc;
    shot.id = archive.armShot(shot);
    shot.state = db::ShotState::kCaptured;
    const Bytes png = encodePng(
        Image<std::uint8_t>(kSize.width, kSize.height, 3, static_cast<std::uint8_t>(level)).view());
    db::PendingFrame frame;
    frame.ext = "png";
    frame.bytes = png;
    frame.size = kSize;
    frame.utc = step.due_utc;
    db::LightCheckRow check;
    check.run_id = "run";
    check.step_id = step.id;
    check.shot_id = shot.id;
    check.light_state = light;
    check.source = "patch:cam0";
    check.channel = "g";
    check.level = step.number == 11 ? 0.45 : 0.5;
    check.verdict = "pass";
    check.utc = step.due_utc;
    archive.acknowledge(shot, {&frame, 1}, {&check, 1}, kBegin);
    last_ = sha256(png);
  }
  std::vector<RecalledPicture> recalled(int steps_most, const std::function<bool()>& time_left) {
    return recallPictures(db::ArchiveReader(folder_.path()), "run", {{"cam0", {0, 0, 8, 8}}},
                          steps_most, time_left);
  }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  Sha256 last_;
};

TEST_F(Recall, IsOfTheLastStepsInOrderOfTimeWithTilesPatchAndHashes) {
  const auto pictures = recalled(10, [] { return true; });
  ASSERT_EQ(pictures.size(), 20u);
  EXPECT_EQ(pictures.front().utc, kBegin + 2 * std::chrono::minutes(10));
  ASSERT_TRUE(pictures.front().tiles);
  EXPECT_EQ(pictures.front().tiles->columns, 16);
  EXPECT_EQ(pictures.front().tiles->level.front(), 0) << "the patch's";
  EXPECT_LT(pictures.front().tiles->level.back(), pictures.back().tiles->level.back());
  EXPECT_EQ(pictures.front().patch, 0);
  EXPECT_NEAR(pictures.back().patch, -0.1, 1e-6);
  EXPECT_EQ(pictures.back().light_state, "off");
  ASSERT_EQ(pictures.back().files.size(), 1u);
  EXPECT_EQ(pictures.back().files[0].sha256, last_);
  EXPECT_FALSE(pictures.back().files[0].lit);
  EXPECT_TRUE(pictures.front().files[0].lit);
}

TEST_F(Recall, WithoutTimeIsOfHashesAlone) {
  int left = 3;
  const auto pictures = recalled(4, [&] { return left-- > 0; });
  ASSERT_EQ(pictures.size(), 8u);
  EXPECT_TRUE(pictures[2].tiles);
  EXPECT_FALSE(pictures[3].tiles);
  EXPECT_EQ(pictures.back().files[0].sha256, last_);
}

TEST_F(Recall, OfAFileThatIsGoneIsItsHash) {
  std::filesystem::remove_all(folder_ / "frames");
  const auto pictures = recalled(2, [] { return true; });
  ASSERT_EQ(pictures.size(), 4u);
  EXPECT_FALSE(pictures[0].tiles);
  EXPECT_EQ(pictures.back().files[0].sha256, last_);
}

}  // namespace
}  // namespace patina::capture
