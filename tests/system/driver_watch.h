// SPDX-License-Identifier: GPL-3.0-or-later
// What the processes of a camera's driver take while they live, seen from outside.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "tests/support/resources.h"

namespace patina::testing {

class DriverWatch {
 public:
  // Now and then; not while a process starts.
  void look() {
    for (const pid_t pid : childrenOf(::getpid()))
      if (const auto taken = resourcesOf(pid, "")) {
        Life& life = lives_.try_emplace(pid, Life{*taken, *taken}).first->second;
        life.last = *taken;
        ++life.looks;
      }
  }
  // The most that one of them grew, from its first look to its last.
  Resources growth() const {
    Resources most;
    for (const auto& [pid, life] : lives_) {
      most.descriptors = std::max(most.descriptors, life.last.descriptors - life.first.descriptors);
      most.resident_bytes =
          std::max(most.resident_bytes, life.last.resident_bytes - life.first.resident_bytes);
    }
    return most;
  }
  int longestLife() const {  // in looks
    int longest = 0;
    for (const auto& [pid, life] : lives_) longest = std::max(longest, life.looks);
    return longest;
  }
  std::string text() const {
    char text[120];
    std::snprintf(text, sizeof text,
                  "%zu driver processes, one for up to %d steps, %+d descriptors, %+.1f MB",
                  lives_.size(), longestLife(), growth().descriptors,
                  growth().resident_bytes / 1e6);
    return text;
  }

 private:
  struct Life {
    Resources first, last;
    int looks = 0;
  };
  std::map<pid_t, Life> lives_;
};

}  // namespace patina::testing
