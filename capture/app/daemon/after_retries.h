// SPDX-License-Identifier: GPL-3.0-or-later
// Which runs' products are tried again after a failure, and when: what fails once, for want of
// memory or room, may well be made an hour later; what fails four times waits for a person.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "processing/image/units.h"

namespace patina::daemon {

// Thread-safe.
class AfterRetries {
 public:
  // The wait until it is tried again: 1 min, 10 min, 1 h; nothing: it has failed too often.
  std::optional<Nanoseconds> failed(const std::string& run_id, MonoTime now);
  void done(const std::string& run_id);
  // Those whose wait is over; each is named once.
  std::vector<std::string> due(MonoTime now);

 private:
  struct Trouble {
    std::size_t failures = 0;
    std::optional<MonoTime> again;
  };
  std::mutex mutex_;  // guards what follows
  std::map<std::string, Trouble> troubles_;
};

}  // namespace patina::daemon
