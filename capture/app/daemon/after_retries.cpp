// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/after_retries.h"

#include <array>

namespace patina::daemon {
namespace {

using namespace std::chrono_literals;

constexpr std::array<Nanoseconds, 3> kWaits = {1min, 10min, 1h};

}  // namespace

std::optional<Nanoseconds> AfterRetries::failed(const std::string& run_id, MonoTime now) {
  const std::lock_guard lock(mutex_);
  Trouble& trouble = troubles_[run_id];
  if (trouble.failures == kWaits.size()) {
    troubles_.erase(run_id);  // asked for again by a person, it begins anew
    return std::nullopt;
  }
  const Nanoseconds wait = kWaits[trouble.failures++];
  trouble.again = now + wait;
  return wait;
}

void AfterRetries::done(const std::string& run_id) {
  const std::lock_guard lock(mutex_);
  troubles_.erase(run_id);
}

std::vector<std::string> AfterRetries::due(MonoTime now) {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> runs;
  for (auto& [run_id, trouble] : troubles_)
    if (trouble.again && *trouble.again <= now) {
      runs.push_back(run_id);
      trouble.again.reset();
    }
  return runs;
}

}  // namespace patina::daemon
