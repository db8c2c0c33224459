// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/run_report.h"

#include <algorithm>
#include <cctype>
#include <map>

namespace patina::workflow {
namespace {

// "late by 412 s" -> "late by # s": reasons that differ in a number are one kind.
std::string kindOf(const std::string& reason) {
  std::string kind;
  for (std::size_t i = 0; i < reason.size(); ++i) {
    const bool digit = std::isdigit(static_cast<unsigned char>(reason[i])) != 0;
    const bool inside_word = !kind.empty() && std::isalpha(static_cast<unsigned char>(kind.back()));
    if (digit && inside_word) {
      while (i < reason.size() && std::isalnum(static_cast<unsigned char>(reason[i])))
        kind += reason[i++];  // "cam0" is a name, not a number
      if (i < reason.size()) kind += reason[i];
    } else if (digit) {
      while (i + 1 < reason.size() &&
             (std::isdigit(static_cast<unsigned char>(reason[i + 1])) || reason[i + 1] == '.'))
        ++i;
      kind += '#';
    } else {
      kind += reason[i];
    }
  }
  return kind;
}

void countStep(const db::StepRow& step, RunReport* report,
               std::map<db::Decision, std::map<std::string, ReasonCount>>* reasons) {
  if (!step.number) {
    ++report->manual;
    return;
  }
  ++report->steps_due;
  switch (step.decision) {
    case db::Decision::kCaptured:
      ++report->captured;
      break;
    case db::Decision::kHeld:
      ++report->held;
      break;
    case db::Decision::kSkipped:
      ++report->skipped;
      break;
    case db::Decision::kMissed:
      ++report->missed;
      break;
    case db::Decision::kFailed:
      ++report->failed;
      break;
    case db::Decision::kPending:
      ++report->pending;
      break;
  }
  if (step.shots_captured > 0 && step.shots_captured < step.shots_due) ++report->partial;
  if (step.decision == db::Decision::kCaptured) {
    if (step.held.count() > 0) ++report->captured_after_hold;
    if (step.retries > 0) ++report->retried;
  }
  report->held_total += step.held;
  if (step.decision == db::Decision::kCaptured) return;
  ReasonCount& entry = (*reasons)[step.decision][kindOf(step.reason)];
  if (entry.steps++ == 0) entry.example = step.reason;
}

}  // namespace

RunReport reportRun(const db::ArchiveReader& archive, const std::string& run_id) {
  RunReport report;
  report.run = archive.findRun(run_id);
  std::map<db::Decision, std::map<std::string, ReasonCount>> reasons;
  for (const db::StepRow& step : archive.steps(report.run.id)) countStep(step, &report, &reasons);
  for (auto& [decision, kinds] : reasons) {
    std::vector<ReasonCount> sorted;
    for (auto& [kind, count] : kinds) {
      count.reason = kind;
      sorted.push_back(count);
    }
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return a.steps > b.steps; });
    report.reasons.emplace_back(db::name(decision), std::move(sorted));
  }
  archive.eachFrame(report.run.id, [&](const db::ArchiveReader::CapturedFrame& f) {
    ++report.frames;
    report.bytes += f.frame.bytes;
  });
  std::map<std::string, std::int64_t> verdicts;
  for (const db::LightCheckRow& check : archive.lightChecks(report.run.id)) {
    ++verdicts[check.verdict];
    if (check.verdict != "correct") continue;
    report.gain_least = std::min(report.gain_least, check.gain);
    report.gain_most = std::max(report.gain_most, check.gain);
  }
  report.light_verdicts.assign(verdicts.begin(), verdicts.end());
  report.events = archive.events(report.run.id);
  return report;
}

}  // namespace patina::workflow
