// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/sweep_pictures.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/dome_run.h"

namespace patina::workflow {
namespace {

using ::testing::ElementsAre;
using testing::MadeShot;
using testing::TempFolder;

TEST(PlanSweeps, TakesWholeStepsAndSingleLampsAndNamesTheRest) {
  const TempFolder folder = TempFolder::inMemory();
  MadeShot second, tenth, both, off;
  second.light = "l2", tenth.light = "l10", both.light = "l2+l10", off.light = "off";
  const std::string run = testing::makeRun(
      folder.path(),
      {{{second, tenth, both, off}}, {{second, tenth}, 4}, {{second, tenth, both, off}}});
  const SweepPlan plan = planSweeps(db::ArchiveReader(folder.path()), run, {});
  EXPECT_THAT(plan.states, ElementsAre("l2", "l10"));
  EXPECT_THAT(plan.other_states, ElementsAre("l2+l10"));
  EXPECT_THAT(plan.partial, ElementsAre(1));
  ASSERT_EQ(plan.steps.size(), 2u);
  EXPECT_EQ(plan.steps[1].number, 2);
  EXPECT_EQ(plan.steps[1].frame_sha256s.size(), 2u);
}

TEST(PlanSweeps, RefusesARunWithoutALampAlone) {
  const TempFolder folder = TempFolder::inMemory();
  MadeShot off;
  off.light = "off";
  const std::string run = testing::makeRun(folder.path(), {{{off}}});
  EXPECT_THROW(planSweeps(db::ArchiveReader(folder.path()), run, {}), WorkflowError);
}

class SweepsOfADome : public ::testing::Test {
 protected:
  // Ratio of the brightness in each picture of each step to that of its first.
  std::vector<double> brightness(std::size_t from) {
    const std::string run = testing::makeDomeRun(folder_.path(), 3);
    const db::ArchiveReader reader(folder_.path());
    const SweepPlan plan = planSweeps(reader, run, {});
    Progress progress;
    Sweeps sweeps(reader, reader.findRun(run), plan, {}, from, progress);
    std::vector<double> worst;
    for (std::size_t k = from; auto sweep = sweeps.next(); ++k) {
      double off = 0;
      for (const SweepPicture& one : sweep->pictures)
        off = std::max(off, offOf(one, plan.steps[k]));
      worst.push_back(off);
    }
    return worst;
  }
  // Of what the surface shows under this lamp at the step's own moment.
  static double offOf(const SweepPicture& one, const SweepStep& step) {
    brdf::SurfaceLight light = brdf::dome(testing::kDomeLamps, 60)[one.state];
    light.strength = static_cast<float>(testing::domeBrightness(step.time_s)) / light.direction.z;
    const Image<float> want = brdf::relight(testing::domeTruth(), {}, light);
    double seen = 0, all = 0;
    for (const float v : one.linear.texels()) seen += v;
    for (const float v : want.texels()) all += v;
    return std::abs(seen / all - 1);
  }
  TempFolder folder_ = TempFolder::inMemory();
};

// Uncorrected, the first and last lamp of a sweep are off by 3.5 %.
TEST_F(SweepsOfADome, ShowEveryLampAsOfTheStepsMoment) {
  const auto worst = brightness(0);
  ASSERT_EQ(worst.size(), 3u);
  for (const double off : worst) EXPECT_LT(off, 0.002);
}

TEST_F(SweepsOfADome, CanBeginAtAnyStep) {
  const auto worst = brightness(2);
  ASSERT_EQ(worst.size(), 1u);
  EXPECT_LT(worst[0], 0.002);
}

// A picture of one texel at level 1, with `before` 10 s earlier and `behind` 10 s later, 2 s on.
float movedBy2s(std::optional<float> before, std::optional<float> behind) {
  Image<float> picture(1, 1, 1, 1.0f);
  const Image<float> earlier(1, 1, 1, before.value_or(0)), later(1, 1, 1, behind.value_or(0));
  std::optional<TimedPicture> b, e;
  if (before) b = {-10, earlier.view()};
  if (behind) e = {10, later.view()};
  moveInTime(picture, b, e, 2);
  return picture.at(0, 0);
}

TEST(MoveInTime, FollowsWhatChangesEvenly) {
  EXPECT_FLOAT_EQ(movedBy2s(0.5f, 1.5f), 1.1f);
  EXPECT_FLOAT_EQ(movedBy2s({}, 1.5f), 1.1f);
  EXPECT_FLOAT_EQ(movedBy2s(0.5f, {}), 1.1f);
  EXPECT_FLOAT_EQ(movedBy2s({}, {}), 1);
}

TEST(MoveInTime, DoesNotSmearWhatChangesAtOnce) {
  EXPECT_FLOAT_EQ(movedBy2s(1.0f, 3.0f), 1);
  EXPECT_FLOAT_EQ(movedBy2s(1.5f, 1.5f), 1);  // a peak
  EXPECT_LT(movedBy2s(0.98f, 3.0f), 1.01f);
}

TEST(MoveInTime, LeavesWhatIsNotKnownThereAsItIs) {
  const float unknown = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FLOAT_EQ(movedBy2s(unknown, 2.0f), 1);
  EXPECT_FLOAT_EQ(movedBy2s({}, unknown), 1);
}

}  // namespace
}  // namespace patina::workflow
