// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/sim/oracle_verdict.h"

#include <algorithm>
#include <set>
#include <tuple>

namespace patina::testing {
namespace {

std::string describe(const OracleVerdict::Truth& t) {
  return t.camera + " " + t.light_state + " " + formatExposure(t.exposure) + " at " +
         std::to_string(toSeconds(t.at)) + " s";
}

}  // namespace

void OracleVerdict::read(const std::filesystem::path& archive, const std::string& run_id) {
  const db::ArchiveReader reader(archive);
  step_rows_ = reader.steps(run_id);
  reader.eachFrame(run_id, [&](const db::ArchiveReader::CapturedFrame& f) {
    found_.push_back({f.step, f.shot, f.frame});
    try {
      reader.read(f.frame);  // checks the hash
    } catch (const Failure& e) {
      problem(e.what());
    }
  });
  Progress silent;
  for (const auto& p : db::verify(archive, silent).problems)
    problem("verify: " + p.what + " " + p.path + " " + p.detail);
}

void OracleVerdict::acknowledged(db::RowId shot_id, int file_index, const std::string& sha256) {
  const auto rows = std::ranges::count_if(found_, [&](const Found& f) {
    return f.shot.id == shot_id && f.frame.file_index == file_index &&
           f.frame.sha256.hex() == sha256;
  });
  if (rows == 0) problem("acknowledged and lost: shot " + std::to_string(shot_id) + " " + sha256);
  if (rows > 1) problem("acknowledged and doubled: shot " + std::to_string(shot_id));
}

// The picture was taken by that camera, under those lamps, and not before its step was due.
bool OracleVerdict::fits(const Found& found, const Truth& truth) const {
  return truth.camera == found.shot.device_id && truth.light_state == found.shot.light_state &&
         truth.exposure == found.shot.exposure &&
         truth.at >= found.step.number.value_or(0) * plan_.interval;
}

// A sweep may run on beyond its slot, but then the slots it runs into have no picture before its
// last: in order of time, pictures are in the order of their steps.
void OracleVerdict::order() {
  std::ranges::sort(taken_in_);
  for (std::size_t i = 1; i < taken_in_.size(); ++i)
    if (taken_in_[i].second < taken_in_[i - 1].second)
      problem("step " + std::to_string(taken_in_[i].second) +
              " holds a picture younger than one of " + "step " +
              std::to_string(taken_in_[i - 1].second));
}

void OracleVerdict::frames(
    const std::function<std::vector<Truth>(const std::string& sha256)>& truths_of) {
  std::set<std::tuple<db::RowId, std::string, std::string, int, int>> places;
  for (const Found& f : found_) {
    const std::string where = "step " + std::to_string(f.step.number.value_or(-1)) + " " +
                              f.shot.device_id + " " + f.shot.light_state + " " +
                              formatExposure(f.shot.exposure);
    if (!places
             .insert({f.step.id, f.shot.device_id, f.shot.light_state, f.shot.exposure_index,
                      f.frame.file_index})
             .second)
      problem(where + " is there twice");
    const auto truths = truths_of(f.frame.sha256.hex());
    if (truths.empty()) problem(where + " holds a file that no camera made");
    const auto fitting = std::ranges::find_if(truths, [&](const Truth& t) { return fits(f, t); });
    if (!truths.empty() && fitting == truths.end())
      problem(where + " holds a picture of " + describe(truths.front()));
    if (!f.step.number) continue;
    if (fitting != truths.end()) taken_in_.emplace_back(fitting->at, *f.step.number);
    ++files_of_[*f.step.number][{f.shot.device_id, f.shot.light_state, f.shot.exposure}];
  }
  order();
}

bool OracleVerdict::isWhole(const db::StepRow& row) const {
  const auto at = files_of_.find(*row.number);
  std::map<Owed, int> owed;
  for (const Owed& o : plan_.owed) owed[o] += plan_.files_a_shot;
  return at != files_of_.end() && at->second == owed;
}

void OracleVerdict::mustBeAlive(std::int64_t slot, const db::StepRow& row) {
  if (slot * plan_.interval < plan_.healed) return;
  if (++due_in_calm_ <= kGrace + plan_.waiting) return;
  if (row.decision != db::Decision::kCaptured)
    problem("all is well, but step " + std::to_string(slot) + " is " + db::name(row.decision) +
            ": " + row.reason);
}

void OracleVerdict::judgeSlot(std::int64_t slot, const std::vector<const db::StepRow*>& rows) {
  const std::string name = "step " + std::to_string(slot);
  if (!plan_.isDue(t0_, slot)) {
    if (!rows.empty()) problem(name + " has a row, but was not due");
    return;
  }
  if (rows.size() != 1) {
    problem(name + " was due and has " + std::to_string(rows.size()) + " rows");
    return;
  }
  const db::StepRow& row = *rows.front();
  const bool whole = isWhole(row);
  if (row.decision == db::Decision::kPending) problem(name + " was never decided");
  if (whole != (row.decision == db::Decision::kCaptured))
    problem(name + " is called " + db::name(row.decision) + ", but its pictures are " +
            (whole ? "all" : "not all") + " there");
  mustBeAlive(slot, row);
}

void OracleVerdict::steps() {
  std::map<std::int64_t, std::vector<const db::StepRow*>> rows;
  for (const db::StepRow& row : step_rows_)
    if (row.number) rows[*row.number].push_back(&row);
  for (std::int64_t slot = 0; slot < plan_.steps; ++slot) judgeSlot(slot, rows[slot]);
  for (const auto& [slot, of_slot] : rows)
    if (slot < 0 || slot >= plan_.steps)
      problem("step " + std::to_string(slot) + " is beyond the plan");
}

}  // namespace patina::testing
