// SPDX-License-Identifier: GPL-3.0-or-later
// The gphoto2 command line against the virtual DSLR over PTP/IP, as a user would run it.
#include <gtest/gtest.h>

#include "devices/twin/dslr/ptpip_server.h"
#include "processing/image/sha256.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/devices/twin/dslr/gphoto2_cli.h"

namespace patina::devices::twin::dslr {
namespace {

using namespace std::chrono_literals;

class Gphoto2 : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::Gphoto2Cli::isThere()) GTEST_SKIP() << "gphoto2 is not installed";
  }
  static bool says(const testing::Finished& done, const std::string& text) {
    return done.out.find(text) != std::string::npos;
  }
  void hasSaved(const std::filesystem::path& file, const TrueFile& truth) {
    EXPECT_EQ(sha256OfFile(file), truth.hash);
    EXPECT_EQ(readPicture(file).linear.width(), 64);
  }

  RealClock clock_;
  std::shared_ptr<World> world_ = dslrWorld(clock_);
  Dslr camera_{world_, {.save = 5ms}};
  PtpIpServer server_{camera_};
  testing::Gphoto2Cli gphoto2_{server_.gphotoPort()};
};

TEST_F(Gphoto2, ReadsTheSummary) {
  const auto done = gphoto2_({"--summary"});
  EXPECT_EQ(done.exit, 0) << done.err;
  for (const char* text : {"Model: Patina DSLR", "Serial Number: 1001", "Generic Image Capture",
                           "Storage Type: Removable RAM (memory card)", "value: JPEG Fine (2)"})
    EXPECT_TRUE(says(done, text)) << text << '\n' << done.out;
}

TEST_F(Gphoto2, ListsItsConfiguration) {
  const auto done = gphoto2_({"--list-config"});
  EXPECT_EQ(done.exit, 0) << done.err;
  for (const char* path : {"/main/imgsettings/iso", "/main/capturesettings/shutterspeed",
                           "/main/capturesettings/f-number", "/main/imgsettings/whitebalance",
                           "/main/capturesettings/imagequality", "/main/status/batterylevel",
                           "/main/settings/datetime", "/main/other/dff1"})
    EXPECT_TRUE(says(done, path)) << path << '\n' << done.out;
}

TEST_F(Gphoto2, ReadsBackWhatItSets) {
  const auto done = gphoto2_({"--set-config-value", "shutterspeed=1/50", "--set-config", "iso=400",
                              "--get-config", "shutterspeed", "--get-config", "iso"});
  EXPECT_EQ(done.exit, 0) << done.err;
  EXPECT_TRUE(says(done, "Current: 0.0200s")) << done.out;
  EXPECT_TRUE(says(done, "Current: 400")) << done.out;
}

TEST_F(Gphoto2, IsToldThatAValueIsNoChoice) {
  const auto done = gphoto2_({"--set-config-value", "iso=123"});
  EXPECT_EQ(done.exit, 1);
  EXPECT_NE(done.err.find("Invalid Device Prop Value"), std::string::npos) << done.err;
  EXPECT_TRUE(says(gphoto2_({"--get-config", "iso"}), "Current: 100"));
}

TEST_F(Gphoto2, CapturesAndDownloadsWhatTheCameraTook) {
  world_->setLamp(0, 1);
  const auto file = gphoto2_.folder / "a.jpg";
  const auto done =
      gphoto2_({"--set-config-value", "f-number=f/4", "--set-config-value", "shutterspeed=0.0100",
                "--capture-image-and-download", "--filename", file.string()});
  ASSERT_EQ(done.exit, 0) << done.err;
  const Truth truth = camera_.truth();
  ASSERT_EQ(truth.pictures.size(), 1u);
  hasSaved(file, truth.pictures[0].files.at(0));
  EXPECT_EQ(truth.pictures[0].exposure, (Exposure{10ms, Iso{100}, FNumber{4}}));
  EXPECT_GT(truth.pictures[0].levels.at(0), 0.9);
  EXPECT_TRUE(truth.pictures[0].files[0].deleted_utc);
}

TEST_F(Gphoto2, ListsGetsAndDeletesPairs) {
  const auto shot = gphoto2_(
      {"--set-config-value", "imagequality=NEF+Fine", "--trigger-capture", "--wait-event=1s"});
  ASSERT_EQ(shot.exit, 0) << shot.err;
  const auto listed = gphoto2_({"--list-files"});
  EXPECT_TRUE(says(listed, "PATN0001.DNG")) << listed.out;
  EXPECT_TRUE(says(listed, "PATN0001.JPG")) << listed.out;
  const std::string pattern = (gphoto2_.folder / "%f.%C").string();
  const auto got = gphoto2_({"--get-all-files", "--filename", pattern});
  ASSERT_EQ(got.exit, 0) << got.err;
  const auto files = camera_.truth().pictures.at(0).files;
  ASSERT_EQ(files.size(), 2u);
  int saved = 0;
  for (const auto& entry : std::filesystem::directory_iterator(gphoto2_.folder.path())) {
    if (!entry.path().filename().string().starts_with("PATN0001")) continue;
    ++saved;
    const Sha256 hash = sha256OfFile(entry.path());
    EXPECT_TRUE(hash == files[0].hash || hash == files[1].hash) << entry.path();
  }
  EXPECT_EQ(saved, 2);
  EXPECT_EQ(gphoto2_({"--delete-all-files", "--recurse"}).exit, 0);
  const Truth truth = camera_.truth();
  for (const TrueFile& file : truth.pictures.at(0).files)
    EXPECT_TRUE(file.deleted_utc) << file.name;
}

TEST_F(Gphoto2, CapturesToMemory) {
  const auto file = gphoto2_.folder / "m.jpg";
  const auto done = gphoto2_({"--set-config-value", "dff1=2", "--capture-image-and-download",
                              "--filename", file.string()});
  ASSERT_EQ(done.exit, 0) << done.err;
  const auto truth = camera_.truth().pictures.at(0).files.at(0);
  EXPECT_EQ(truth.store, kMemoryStore);
  hasSaved(file, truth);
}

TEST_F(Gphoto2, FailsWhenTheCameraRefuses) {
  camera_.order({.kind = DslrFaultKind::kReset, .operation = Operation::kInitiateCapture});
  EXPECT_NE(gphoto2_({"--trigger-capture"}).exit, 0);
  EXPECT_EQ(gphoto2_({"--summary"}).exit, 0);
}

}  // namespace
}  // namespace patina::devices::twin::dslr
