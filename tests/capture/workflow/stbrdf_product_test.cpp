// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/stbrdf_product.h"

#include <gmock/gmock.h>

#include "processing/stbrdf/stbrdf_file.h"
#include "tests/capture/workflow/dome_run.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

class StbrdfProduct : public ::testing::Test {
 protected:
  StbrdfProduct() {
    Progress progress;
    brdf_ = *fitRun(folder_.path(), testing::domeRequest(testing::makeDomeRun(folder_.path(), 3)),
                    testing::now(), progress)
                 .product;
  }
  StbrdfOutcome fit() {
    Progress progress;
    return fitStbrdf(folder_.path(), {"latest", 5, "test", "1", ""}, testing::now(), progress);
  }
  TempFolder folder_ = TempFolder::inMemory();
  db::ProductRow brdf_;
};

TEST_F(StbrdfProduct, IsPolynomialsOverTheTimesOfTheSets) {
  const StbrdfOutcome outcome = fit();
  EXPECT_EQ(outcome.degree, 2);  // three steps
  Progress progress;
  const stbrdf::StbrdfSet set = stbrdf::readStbrdfSet(outcome.set, progress);
  const Image<float> end = evaluate(*set.find("Diffuse"), set.basis, 1, stbrdf::Clamp::kNone);
  const auto set_folder = pathOfProduct(folder_.path(), brdf_).parent_path();
  const brdf::BrdfMaps last = brdf::readBrdfMaps(set_folder, brdf::readBrdfSetInfo(set_folder), 2);
  EXPECT_LT(brdf::rms(end, last.diffuse), 1e-4);
  EXPECT_THAT(outcome.product.input_sha256s, ::testing::ElementsAre(brdf_.sha256));
}

TEST_F(StbrdfProduct, TakesThePlaceOfWhatAKilledFitHasLeft) {
  const std::string id = "stbrdf-" + brdf_.id.substr(5) + "-1";
  std::filesystem::create_directories(db::ProductWriter::folderFor(folder_.path(), id) / "rest");
  const StbrdfOutcome outcome = fit();
  EXPECT_EQ(outcome.product.id, id);
  EXPECT_FALSE(std::filesystem::exists(outcome.set / "rest"));
}

}  // namespace
}  // namespace patina::workflow
