// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "capture/app/http/credentials.h"
#include "capture/app/http/private_file.h"
#include "tests/capture/app/http/manual_clock.h"
#include "tests/support/temp_folder.h"

namespace patina::http {
namespace {

TEST(KeptTokens, OutliveTheProcessAsHashesOnly) {
  const auto folder = testing::TempFolder::inMemory();
  const std::string token = addKeptToken(folder / "tokens", "prometheus", Role::kViewer);
  const std::string text = testing::readFile(folder / "tokens");
  EXPECT_EQ(text, "prometheus viewer " + sha256(token).hex() + "\n");
  EXPECT_EQ(text.find(token), std::string::npos);
  ManualClock clock;
  EXPECT_EQ(Credentials(clock, folder / "tokens").roleOfBearer(token), Role::kViewer);
}

TEST(KeptTokens, LieInAFileThatOnlyTheOwnerMayRead) {
  const auto folder = testing::TempFolder::inMemory();
  addKeptToken(folder / "tokens", "x", Role::kViewer);
  struct stat facts {};
  ASSERT_EQ(stat((folder / "tokens").c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0600u);
}

TEST(KeptTokens, RefuseALineThatIsNotWhole) {
  const auto folder = testing::TempFolder::inMemory();
  const std::string hash(64, 'a');
  for (const std::string& line :
       {"x viewer " + hash + " more", "x public " + hash, std::string("x viewer ab"),
        "../x viewer " + hash, "x viewer " + std::string(64, 'g'), std::string("x")}) {
    writePrivateFile(folder / "tokens", line + "\n");
    EXPECT_THROW(readKeptTokens(folder / "tokens"), HttpError) << line;
  }
}

TEST(KeptTokens, AreNoneWhenThereIsNoFile) {
  const auto folder = testing::TempFolder::inMemory();
  EXPECT_TRUE(readKeptTokens(folder / "tokens").empty());
}

}  // namespace
}  // namespace patina::http
