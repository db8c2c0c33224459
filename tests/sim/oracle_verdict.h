// SPDX-License-Identifier: GPL-3.0-or-later
// The invariants of a week, each written out against what the oracle saw.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "db/archive.h"
#include "tests/sim/week_plan.h"

namespace patina::testing {

class OracleVerdict {
 public:
  struct Truth {  // of a picture that was taken
    std::string camera, light_state;
    Nanoseconds exposure{}, at{};  // world time since the run's start
  };

  OracleVerdict(const WeekPlan& plan, UtcTime t0) : plan_(plan), t0_(t0) {}

  void read(const std::filesystem::path& archive, const std::string& run_id);
  void acknowledged(db::RowId shot_id, int file_index, const std::string& sha256);
  void frames(const std::function<std::vector<Truth>(const std::string& sha256)>& truths_of);
  void steps();
  std::int64_t calmSteps() const { return std::max(0, due_in_calm_ - kGrace - plan_.waiting); }
  void problem(const std::string& what) { problems_.push_back(what); }
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  // Due steps of the calm that may still suffer from what was before it: two intervals.
  static constexpr int kGrace = 2;
  struct Found {
    db::StepRow step;
    db::ShotRow shot;
    db::FrameRow frame;
  };
  bool fits(const Found& found, const Truth& truth) const;
  void order();
  void judgeSlot(std::int64_t slot, const std::vector<const db::StepRow*>& rows);
  bool isWhole(const db::StepRow& row) const;
  void mustBeAlive(std::int64_t slot, const db::StepRow& row);

  const WeekPlan& plan_;
  UtcTime t0_;
  std::vector<Found> found_;
  std::vector<db::StepRow> step_rows_;
  std::map<std::int64_t, std::map<Owed, int>> files_of_;        // by slot
  std::vector<std::pair<Nanoseconds, std::int64_t>> taken_in_;  // when, for which step
  int due_in_calm_ = 0;
  std::vector<std::string> problems_;
};

}  // namespace patina::testing
