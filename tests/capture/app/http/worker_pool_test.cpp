// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/worker_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <latch>

namespace patina::http {
namespace {

TEST(WorkerPool, RunsWhatWasSubmittedBeforeItStops) {
  std::atomic<int> done{0};
  WorkerPool pool(2);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(pool.submit([&done] { ++done; }));
  pool.stop();
  EXPECT_EQ(done, 100);
  EXPECT_FALSE(pool.submit([&done] { ++done; }));
  EXPECT_EQ(done, 100);
}

TEST(WorkerPool, GoesOnWhileOneJobWaits) {
  std::latch release(1), other(1);
  WorkerPool pool(2);
  pool.submit([&release] { release.wait(); });
  pool.submit([&other] { other.count_down(); });
  other.wait();
  release.count_down();
}

}  // namespace
}  // namespace patina::http
