// SPDX-License-Identifier: GPL-3.0-or-later
// What a run leaves when it is interrupted anywhere.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>

#include "processing/image/progress.h"

namespace patina::texture_optimization {

// Asks to stop at the `last`-th step it is told of.
class StopsAt final : public Progress {
 public:
  explicit StopsAt(int last) : left_(last) {}

 protected:
  void advance(std::int64_t) override {
    if (--left_ <= 0) askToStop();
  }

 private:
  std::atomic<int> left_;
};

// Runs `body(progress)`, which writes into `folder`, stopped at its first step, its second, ...
// until it comes to its end; `folder` has to be as empty as before each time. How often it was
// stopped.
template <class Body>
int stoppedEverywhere(const std::filesystem::path& folder, const Body& body) {
  for (int last = 1;; ++last) {
    StopsAt progress(last);
    try {
      body(progress);
      return last - 1;
    } catch (const Stopped&) {
      EXPECT_TRUE(std::filesystem::is_empty(folder)) << last;
    }
    if (last == 1000 || !std::filesystem::is_empty(folder)) return -1;
  }
}

}  // namespace patina::texture_optimization
