// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/background.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace patina::db::care {

bool giveWay() {
  constexpr int kLeastNice = 19;
  // ioprio_set(2); newer kernels' <linux/ioprio.h> is no C++.
  constexpr int kWhoProcess = 1, kClassIdle = 3, kClassShift = 13;
  const bool idle = ::syscall(SYS_ioprio_set, kWhoProcess, 0, kClassIdle << kClassShift) == 0;
  // Of the thread: Linux takes "this process" for the caller alone.
  return ::setpriority(PRIO_PROCESS, 0, kLeastNice) == 0 && idle;
}

}  // namespace patina::db::care
