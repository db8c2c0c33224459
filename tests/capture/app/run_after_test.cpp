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

TEST_F(DaemonsProducts, AreMadeWhenARunEnds) {
  begin();
  const std::string plan =
      changedPlan(files_, {{"\"10min\"", "\"1min\""}, {"\"2h\"", "\"30min\""}});
  const std::string id = answer({"run", "start", plan}).text("/items/0/id");
  EXPECT_TRUE(waitFor("making products"));
  EXPECT_TRUE(waitFor("no run"));
  EXPECT_EQ(answer({"ttf", "list"}).size("/items"), 1u);
  EXPECT_EQ(end(SIGTERM).exit, 0);
}

}  // namespace
}  // namespace patina::testing
