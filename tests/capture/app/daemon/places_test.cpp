// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/places.h"

#include <gmock/gmock.h>

#include <cstdlib>

#include "capture/failure.h"
#include "tests/support/temp_folder.h"

namespace patina::daemon {
namespace {

class PlacesTest : public ::testing::Test {
 protected:
  PlacesTest() { setenv("RUNTIME_DIRECTORY", (folder_ / "run").c_str(), 1); }
  ~PlacesTest() override { unsetenv("RUNTIME_DIRECTORY"); }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
};

TEST_F(PlacesTest, TheNameIsTheArchivesHoweverItIsWritten) {
  std::filesystem::create_directories(folder_ / "archive");
  std::filesystem::create_directory_symlink(folder_ / "archive", folder_ / "link");
  const std::string name = nameOfArchive(folder_ / "archive");
  EXPECT_EQ(name.size(), 16u);
  EXPECT_EQ(nameOfArchive(folder_ / "link"), name);
  EXPECT_EQ(nameOfArchive(folder_ / "x/../archive/."), name);
  EXPECT_NE(nameOfArchive(folder_ / "other"), name);
}

TEST_F(PlacesTest, SystemdsFolderComesFirst) {
  const Places places = placesToListen(folder_ / "archive");
  EXPECT_EQ(places.socket.parent_path(), folder_ / "run");
  EXPECT_EQ(places.socket.extension(), ".sock");
  EXPECT_EQ(places.token.extension(), ".token");
  EXPECT_TRUE(std::filesystem::is_directory(folder_ / "run"));
}

TEST_F(PlacesTest, ACallerFindsTheSocketThatIsThere) {
  const Places places = placesToListen(folder_ / "archive");
  testing::writeFile(places.socket, "");
  EXPECT_EQ(placesToCall(folder_ / "archive").socket, places.socket);
}

TEST_F(PlacesTest, WithoutADaemonACallerIsToldHowToStartOne) {
  try {
    placesToCall(folder_ / "archive");
    FAIL();
  } catch (const capture::CaptureError& error) {
    EXPECT_EQ(error.exit(), Exit::kUnavailable);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("patina daemon --archive"));
  }
}

}  // namespace
}  // namespace patina::daemon
