// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/spawner.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace patina::daemon {
namespace {

int niceness() { return getpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid))); }

int nicenessStartedBy(Spawner& spawner) {
  int found = 99;
  spawner.start([&found] { found = niceness(); }).join();
  return found;
}

TEST(Spawner, GivesAThreadItsOwnPriorityWhateverThatOfWhoAsks) {
  Spawner spawner;
  const int asked_in_front = nicenessStartedBy(spawner);
  EXPECT_LE(asked_in_front, niceness());
  int asked_from_behind = 99;
  std::thread([&] {
    setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), 15);
    ASSERT_EQ(niceness(), 15);
    asked_from_behind = nicenessStartedBy(spawner);
  }).join();
  EXPECT_EQ(asked_from_behind, asked_in_front);
}

TEST(Spawner, ItsThreadsOutliveIt) {
  std::promise<void> go;
  bool done = false;
  std::thread thread;
  {
    Spawner spawner;
    thread = spawner.start([&] {
      go.get_future().wait();
      done = true;
    });
  }
  go.set_value();
  thread.join();
  EXPECT_TRUE(done);
}

}  // namespace
}  // namespace patina::daemon
