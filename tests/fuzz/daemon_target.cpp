// SPDX-License-Identifier: GPL-3.0-or-later
// JSON that clients send to the daemon, and what a client reads of an answer that may come from
// anybody.
#include "capture/app/daemon/json_rows.h"
#include "capture/app/daemon/watch_lines.h"
#include "capture/failure.h"
#include "tests/fuzz/targets.h"

namespace patina::testing {
namespace {

using namespace daemon;

void checkScreen(const WatchLines& watch, int columns) {
  for (const std::string& line : watch.screen(columns)) {
    PATINA_CHECK(line.size() <= static_cast<std::size_t>(columns));
    for (const char c : line) PATINA_CHECK(static_cast<unsigned char>(c) >= ' ' && c != 127);
  }
}

void readAll(const std::string& text) {
  if (const auto wish = startWishOf(text)) {
    const auto again = startWishOf(jsonOf(*wish));
    PATINA_CHECK(again && again->plan == wish->plan && again->new_run == wish->new_run);
  }
  WatchLines watch("");
  watch.take(runsOf(text));
  for (const char* event : {"run", "status", "alert", "step"}) watch.take(event, text);
  checkScreen(watch, 80);
  checkScreen(watch, 1);
  if (const auto view = runOf(text)) {
    const auto again = runOf(jsonOf(*view));
    PATINA_CHECK(again && again->id == view->id && again->status.step == view->status.step);
  }
  nextOf(text);
  errorOf(text);
  membersOf(text);
}

}  // namespace

void fuzzDaemonJson(std::span<const std::byte> bytes) {
  try {
    readAll(textOf(bytes));
  } catch (const capture::CaptureError&) {
    // Nested too deeply.
  }
}

}  // namespace patina::testing
