// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/background.h"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <thread>

namespace patina::db::care {
namespace {

int ioClass() {
  constexpr int kWhoProcess = 1, kClassShift = 13;
  return static_cast<int>(::syscall(SYS_ioprio_get, kWhoProcess, 0)) >> kClassShift;
}

TEST(Background, IsOfTheCallingThreadAlone) {
  const int before = ioClass();
  int within = -1;
  bool gave_way = false;
  std::thread([&] {
    gave_way = giveWay();
    within = ioClass();
  }).join();
  if (!gave_way) GTEST_SKIP() << "this system has no I/O classes";
  EXPECT_EQ(within, 3);  // IOPRIO_CLASS_IDLE
  EXPECT_EQ(ioClass(), before);
}

}  // namespace
}  // namespace patina::db::care
