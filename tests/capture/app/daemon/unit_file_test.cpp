// SPDX-License-Identifier: GPL-3.0-or-later
// packaging/systemd/patina.service, as systemd itself judges it.
#include <gmock/gmock.h>

#include "tests/support/child.h"
#include "tests/support/places.h"

namespace patina::testing {
namespace {

constexpr const char* kAnalyze = "/usr/bin/systemd-analyze";

class UnitFile : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kAnalyze)) GTEST_SKIP() << "systemd-analyze is not installed";
  }
  const std::string unit_ = sourceFolder() / "packaging/systemd/patina.service";
};

TEST_F(UnitFile, LeavesTheServiceAnExposureOfThreeAtMost) {
  const Finished judged =
      run({kAnalyze, "security", "--offline=true", "--threshold=30", "--no-pager", unit_});
  EXPECT_EQ(judged.exit, 0) << judged.out << judged.err;
}

TEST_F(UnitFile, HasNoLineThatSystemdDoesNotUnderstand) {
  // Where the program is not installed its path would be the only complaint.
  const TempFolder folder = TempFolder::inMemory();
  std::string text = readFile(unit_);
  const std::string installed = "/usr/bin/patina";
  ASSERT_NE(text.find(installed), std::string::npos);
  text.replace(text.find(installed), installed.size(), program().string());
  writeFile(folder / "patina.service", text);
  const Finished verified = run({kAnalyze, "verify", "--man=no", folder / "patina.service"});
  EXPECT_EQ(verified.exit, 0) << verified.err;
  EXPECT_EQ(verified.err, "");
}

}  // namespace
}  // namespace patina::testing
