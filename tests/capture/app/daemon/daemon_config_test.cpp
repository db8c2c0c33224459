// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/daemon_config.h"

#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "tests/support/temp_folder.h"

namespace patina::daemon {
namespace {

using ::testing::HasSubstr;

class LiveConfigTest : public ::testing::Test {
 protected:
  void write(const std::string& text) { testing::writeFile(file_, text); }
  std::string complaint() {
    try {
      config_->reload();
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.exit(), Exit::kConfig);
      return failure.what();
    }
    return "";
  }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  const std::filesystem::path file_ = folder_ / "daemon.toml";
  std::optional<LiveConfig> config_;
};

TEST_F(LiveConfigTest, WithoutAFileTheDefaultsHold) {
  const DaemonConfig config = readDaemonConfig({});
  EXPECT_EQ(config.listen, "127.0.0.1");
  EXPECT_EQ(config.port, 8460);
  EXPECT_TRUE(config.plans.empty());
}

TEST_F(LiveConfigTest, AReloadTakesTheNewFolderOfPlans) {
  write("port = 0\n");
  config_.emplace(file_, "");
  write("port = 0\nplans = \".\"\n");
  EXPECT_THAT(config_->reload(), HasSubstr(folder_.path().string()));
  EXPECT_TRUE(std::filesystem::equivalent(config_->get().plans, folder_.path()));
  EXPECT_EQ(config_->reload(), "nothing has changed");
}

TEST_F(LiveConfigTest, AReloadOfAWrongFileChangesNothingAndSaysWhatIsWrong) {
  write("plans = \".\"\n");
  config_.emplace(file_, "");
  const auto plans = config_->get().plans;
  write("plan = \".\"\n");
  EXPECT_THAT(complaint(), HasSubstr("daemon.toml:1: plan"));
  write("plans = \"nowhere\"\n");
  EXPECT_THAT(complaint(), HasSubstr("nowhere"));
  write("port = 70000\n");
  EXPECT_THAT(complaint(), HasSubstr("port"));
  EXPECT_EQ(config_->get().plans, plans);
}

TEST_F(LiveConfigTest, WhatTakesARestartIsRefused) {
  write("");
  config_.emplace(file_, "");
  write("plans = \".\"\nport = 9000\n");
  EXPECT_THAT(complaint(), HasSubstr("restart"));
  EXPECT_TRUE(config_->get().plans.empty());
}

TEST_F(LiveConfigTest, TheCommandLineStandsAboveTheFile) {
  write("plans = \".\"\n");
  config_.emplace(file_, "/elsewhere");
  EXPECT_EQ(config_->get().plans, "/elsewhere");
}

}  // namespace
}  // namespace patina::daemon
