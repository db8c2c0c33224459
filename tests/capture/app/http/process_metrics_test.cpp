// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <unistd.h>

#include <vector>

#include "capture/app/http/metrics.h"
#include "devices/descriptor.h"

namespace patina::http {
namespace {

TEST(CollectProcess, TellsWhatTheKernelTells) {
  Metrics metrics;
  collectProcess(metrics);
  const double memory = metrics.gauge("process_resident_memory_bytes").value();
  EXPECT_GT(memory, 1e6);
  EXPECT_LT(memory, metrics.gauge("process_virtual_memory_bytes").value());
  EXPECT_GE(metrics.gauge("process_threads").value(), 1);
  EXPECT_GT(metrics.gauge("process_max_fds").value(), metrics.gauge("process_open_fds").value());
  EXPECT_GT(metrics.gauge("process_start_time_seconds").value(), 1.6e9);
}

TEST(CollectProcess, SeesEveryDescriptor) {
  Metrics metrics;
  collectProcess(metrics);
  const double before = metrics.gauge("process_open_fds").value();
  std::vector<devices::Descriptor> more;
  for (int i = 0; i < 5; ++i) more.emplace_back(dup(STDERR_FILENO));
  collectProcess(metrics);
  EXPECT_EQ(metrics.gauge("process_open_fds").value(), before + 5);
}

}  // namespace
}  // namespace patina::http
