// SPDX-License-Identifier: GPL-3.0-or-later
// Progress on a terminal: "building the texture 42 %  1min 20s left", one line that rewrites
// itself.
#pragma once

#include <mutex>
#include <string>

#include "devices/clock.h"
#include "processing/image/progress.h"

namespace patina::app {

// Thread-safe. Draws nothing unless `visible`, and nothing in the first two seconds: a quick
// command leaves no trace.
class ProgressLine final : public Progress {
 public:
  ProgressLine(const devices::Clock& clock, bool visible);
  ~ProgressLine() override;
  void begin(std::string_view stage, std::int64_t total) override;
  void status(const std::string& line);  // instead of a percentage: draws at once, if visible
  void clear();                          // before anything else goes to the terminal

 protected:
  void advance(std::int64_t done) override;

 private:
  void draw(const std::string& line);
  const devices::Clock& clock_;
  const bool visible_;
  const MonoTime started_;
  std::mutex mutex_;
  std::string stage_;
  std::int64_t total_ = 0, done_ = 0;
  MonoTime stage_began_, drawn_;
  bool on_screen_ = false;
};

// "12 s" "3 min 20 s" "2 h 05 min": for people, rounded.
std::string remainingText(double seconds);

}  // namespace patina::app
