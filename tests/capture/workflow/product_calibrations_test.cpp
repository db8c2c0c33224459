// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/product_calibrations.h"

#include <gtest/gtest.h>

#include "capture/workflow/master.h"
#include "capture/workflow/ttf_product.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

class ProductCalibrations : public ::testing::Test {
 protected:
  ProductCalibrations() {
    testing::makeRun(archive_, std::vector<testing::MadeStep>(4, {{testing::MadeShot{}}}));
    std::filesystem::create_directories(folder_ / "darks");
  }
  void makeDark(int level, double exposure_s = 0.02) {
    for (int i = 0; i < 3; ++i)
      testing::plantPng(folder_ / "darks" / (std::to_string(i) + ".png"), {24, 16}, level + i);
    MasterRequest request;
    request.kind = "dark";
    request.folder = folder_ / "darks";
    request.camera = "cam0";
    request.exposure = fromSeconds(exposure_s);
    request.iso = 100;
    Progress progress;
    makeMaster(archive_, request, testing::now(), progress);
  }
  db::ProductRow build() {
    Progress progress;
    TtfRequest request;
    request.run = "latest";
    return makeTtf(archive_, request, testing::now(), progress).product;
  }
  std::vector<std::string> of(const db::ProductRow& product) {
    return textsOf(calibrationsOf(db::ArchiveReader(archive_), product));
  }
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
};

TEST_F(ProductCalibrations, AreNamedAndANewerOneThatFitsBeside) {
  EXPECT_TRUE(of(build()).empty());
  makeDark(5);
  const db::ProductRow first = build();
  EXPECT_EQ(of(first), std::vector<std::string>{"dark 1"});
  makeDark(6, 2);  // of another exposure: no reason to build again
  EXPECT_EQ(of(first), std::vector<std::string>{"dark 1"});
  makeDark(8);
  EXPECT_EQ(of(first), std::vector<std::string>{"dark 1 (dark 3 is newer: build again)"});
}

TEST_F(ProductCalibrations, BuiltAgainANewProductTakesTheNewerOneAndTheOldOneStays) {
  makeDark(5);
  const db::ProductRow first = build();
  makeDark(8);
  const db::ProductRow second = build();
  EXPECT_NE(second.id, first.id);
  EXPECT_NE(second.sha256, first.sha256);
  EXPECT_EQ(of(second), std::vector<std::string>{"dark 2"});
  EXPECT_EQ(db::ArchiveReader(archive_).products("ttf").size(), 2u);
}

}  // namespace
}  // namespace patina::workflow
