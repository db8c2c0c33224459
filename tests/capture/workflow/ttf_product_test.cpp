// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/ttf_product.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::MadeShot;
using testing::MadeStep;
using testing::TempFolder;

class TtfProduct : public ::testing::Test {
 protected:
  TtfProduct() {
    db::ReadingRow wet;
    wet.device_id = "hygro";
    wet.quantity = "humidity";
    wet.unit = "%";
    wet.quality = "ok";
    wet.utc = testing::now();
    wet.value = 60;
    std::vector<MadeStep> steps;
    for (int k = 0; k < 12; ++k) steps.push_back({{MadeShot{.level = 60 + 10 * k}}});
    testing::makeRun(folder_ / "archive", steps, {wet});
  }
  TtfOutcome make(const std::string& out, TtfRequest request = {}) {
    request.run = "latest";
    request.command = "patina ttf build";
    request.version = "0";
    if (!out.empty()) request.out = folder_ / out;
    Progress progress;
    return makeTtf(folder_ / "archive", request, testing::now(), progress);
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(TtfProduct, IsReadBackWithItsTimesAndSources) {
  const TtfOutcome outcome = make("");
  EXPECT_EQ(outcome.path.parent_path().filename(), outcome.product.id);
  const ttf::TtfReader reader(outcome.path);
  EXPECT_EQ(reader.info().frames, 12);
  EXPECT_DOUBLE_EQ(reader.info().time_s[3], 1800);
  EXPECT_EQ(reader.info().source[3].hex(), outcome.frames.input_sha256s[3]);
}

TEST_F(TtfProduct, HasTheSameBytesForAnyNumberOfThreadsAndAnyPlace) {
  const TtfOutcome many = make("many.h5");
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const TtfOutcome single = make("single.h5");
  EXPECT_EQ(many.product.sha256, single.product.sha256);
  EXPECT_NE(many.product.id, single.product.id);
}

TEST_F(TtfProduct, InColoursNamesTheSpaceAndTheCalibrationItCameBy) {
  ColourOutcome chart;
  chart.calibration.camera = "cam0";
  chart.calibration.light = "key";
  chart.calibration.taken_utc = testing::now();
  chart.calibration.model.xyz_from_terms = {1, 0, 0, 0, 0.5, 0, 0, 0, 1};
  const KeptCalibration kept = keepColour(folder_ / "archive", {}, chart, testing::now());
  TtfRequest request;
  request.colour = calibration::ColourSpace::kXyz;
  const TtfOutcome plain = make("plain.h5"), coloured = make("colour.h5", request);
  ASSERT_EQ(coloured.calibrations.size(), 1u);
  EXPECT_THAT(coloured.calibrations[0], ::testing::StartsWith("colour 1"));
  const ttf::TtfReader before(plain.path), after(coloured.path);
  EXPECT_NEAR(after.linearFrame(3).at(2, 2, 1), before.linearFrame(3).at(2, 2, 1) / 2, 2e-5);
  EXPECT_THAT(after.info().provenance_json, ::testing::HasSubstr("xyz-d50"));
  EXPECT_THAT(after.info().provenance_json, ::testing::HasSubstr(kept.row.sha256));
}

TEST_F(TtfProduct, DescribesItselfForTheDatabase) {
  TtfRequest request;
  request.selection.every = 4;
  request.process = "drying";
  const Facts facts = Facts::parse(make("x.h5", request).product.metadata_json);
  EXPECT_EQ(facts.number("frames"), 3);
  EXPECT_EQ(facts.text("process"), "drying");
  EXPECT_EQ(facts.number("humidity_percent"), 60);
  EXPECT_EQ(facts.number("interval_ns"), 40 * 60e9);
  EXPECT_EQ(facts.number("duration_ns"), 80 * 60e9);
}

TEST_F(TtfProduct, RefusesARegionBeyondTheFrames) {
  TtfRequest request;
  request.build.region = RectPx{10, 0, 20, 10};
  EXPECT_THROW(make("x.h5", request), WorkflowError);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.h5"));
  request.build.region = RectPx{4, 0, 20, 10};
  EXPECT_EQ(make("x.h5", request).size, (SizePx{20, 10}));
}

}  // namespace
}  // namespace patina::workflow
