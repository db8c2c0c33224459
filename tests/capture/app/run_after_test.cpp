// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/capture/app/live_daemon.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class RunAfter : public Rehearsed {};

TEST_F(RunAfter, MakesOnlyWhatIsNotThere) {
  const auto products = answer({"run", "after", "latest"});
  EXPECT_EQ(products.size("/items/0/products"), 2u);
  EXPECT_EQ(answer({"run", "after", "latest"}).text("/items/0/products/0"),
            products.text("/items/0/products/0"));
  EXPECT_EQ(patina({"run", "after", "nobody"}).exit, 64);
}

class DaemonsProducts : public LiveDaemon {};

// The run that goes on has its frames already and all that is due of it lies years back: it has the
// same frames at its end however slow the machine is.
TEST_F(DaemonsProducts, AreMadeWhenARunEnds) {
  const std::string plan = changedPlan(files_, {{"\"2h\"", "\"2000h\""}});
  Child rehearsal(
      {program(), "rehearse", plan, "--archive", archive(), "--log-acks", pipe_.path()});
  for (int frames = 0; frames < 5; ++frames) pipe_.line();
  rehearsal.signal(SIGTERM);
  ASSERT_EQ(rehearsal.wait().exit, 0);
  begin();
  answer({"run", "resume", "latest"});
  EXPECT_TRUE(waitFor("making products"));
  EXPECT_TRUE(waitFor("no run"));
  EXPECT_EQ(answer({"ttf", "list"}).size("/items"), 1u);
  EXPECT_EQ(end(SIGTERM).exit, 0);
}

}  // namespace
}  // namespace patina::testing
