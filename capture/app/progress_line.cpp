// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/progress_line.h"

#include <unistd.h>

#include <cstdio>

namespace patina::app {
namespace {

constexpr Nanoseconds kQuietFor = std::chrono::seconds(2);
constexpr Nanoseconds kRedrawAfter = std::chrono::milliseconds(200);

}  // namespace

ProgressLine::ProgressLine(const devices::Clock& clock, bool visible)
    : clock_(clock),
      visible_(visible),
      started_(clock.mono()),
      stage_began_(started_),
      drawn_(started_) {}

ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::begin(std::string_view stage, std::int64_t total) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  total_ = total;
  done_ = 0;
  stage_began_ = clock_.mono();
}

void ProgressLine::advance(std::int64_t done) {
  if (!visible_) return;
  const std::lock_guard lock(mutex_);
  done_ += done;
  const MonoTime now = clock_.mono();
  if (now - started_ < kQuietFor || now - drawn_ < kRedrawAfter) return;
  drawn_ = now;
  if (total_ <= 0) return draw(stage_ + " " + std::to_string(done_));
  const double share = static_cast<double>(done_) / static_cast<double>(total_);
  const double spent = toSeconds(now - stage_began_);
  char percent[16];
  std::snprintf(percent, sizeof percent, " %.0f %%", 100 * std::min(share, 1.0));
  std::string line = stage_ + percent;
  if (share > 0 && share <= 1 && spent > 1)
    line += "  " + remainingText(spent * (1 - share) / share) + " left";
  draw(line);
}

void ProgressLine::status(const std::string& line) {
  if (!visible_) return;
  const std::lock_guard lock(mutex_);
  const MonoTime now = clock_.mono();
  if (on_screen_ && now - drawn_ < kRedrawAfter) return;
  drawn_ = now;
  draw(line);
}

void ProgressLine::draw(const std::string& line) {
  std::fprintf(stderr, "\r%s\033[K", line.c_str());
  std::fflush(stderr);
  on_screen_ = true;
}

void ProgressLine::clear() {
  const std::lock_guard lock(mutex_);
  if (!on_screen_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  on_screen_ = false;
}

std::string remainingText(double seconds) {
  const long s = static_cast<long>(seconds + 0.5);
  char text[48];
  if (s < 60)
    std::snprintf(text, sizeof text, "%ld s", s);
  else if (s < 3600)
    std::snprintf(text, sizeof text, "%ld min %02ld s", s / 60, s % 60);
  else
    std::snprintf(text, sizeof text, "%ld h %02ld min", s / 3600, s / 60 % 60);
  return text;
}

}  // namespace patina::app
