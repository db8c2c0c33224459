// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/background.h"

#include <linux/ioprio.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace patina::db::care {

bool giveWay() {
  constexpr int kLeastNice = 19;
  const bool idle = ::syscall(SYS_ioprio_set, IOPRIO_WHO_PROCESS, 0,
                              IOPRIO_PRIO_VALUE(IOPRIO_CLASS_IDLE, 0)) == 0;
  // Of the thread: Linux takes "this process" for the caller alone.
  return ::setpriority(PRIO_PROCESS, 0, kLeastNice) == 0 && idle;
}

}  // namespace patina::db::care
