// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/background.h"

#include <gtest/gtest.h>
#include <linux/ioprio.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <thread>

namespace patina::db::care {
namespace {

int ioClass() {
  return IOPRIO_PRIO_CLASS(static_cast<int>(::syscall(SYS_ioprio_get, IOPRIO_WHO_PROCESS, 0)));
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
  EXPECT_EQ(within, IOPRIO_CLASS_IDLE);
  EXPECT_EQ(ioClass(), before);
}

}  // namespace
}  // namespace patina::db::care
