// SPDX-License-Identifier: GPL-3.0-or-later
// What `patina run watch` shows, as text: the screen of a terminal, or a line a change.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "capture/app/daemon/run_view.h"

namespace patina::daemon {

class WatchLines {
 public:
  // Empty `run_id`: all runs.
  explicit WatchLines(std::string run_id) : only_(std::move(run_id)) {}

  // As they are now: a line for each that is not as it was.
  std::vector<std::string> take(const std::vector<RunView>& runs);
  // An event of the daemon: a line that says what changed, or nothing when it is of no interest.
  std::string take(const std::string& event, const std::string& json);

  // A line for each run, camera and alert, and one for light, disk and what it waits for; none is
  // longer than `columns`.
  std::vector<std::string> screen(int columns) const;
  bool over() const { return over_; }  // the run that is watched has come to its end

 private:
  std::string changeOf(const RunView& view);
  std::string alertOf(const std::string& json);
  const std::string only_;
  std::map<std::string, RunView> runs_;
  std::map<std::string, std::string> alerts_;  // by run and what: detail
  bool over_ = false;
};

}  // namespace patina::daemon
