// SPDX-License-Identifier: GPL-3.0-or-later
// What happened in a run, told to a person: every step counted, every gap with its reason.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "db/archive.h"

namespace patina::workflow {

struct ReasonCount {
  std::string reason;   // numbers taken out, so that "late by 412 s" and "late by 9 s" are one
  std::string example;  // one of them as it stands in the archive
  std::int64_t steps = 0;
};

struct RunReport {
  db::RunRow run;
  std::int64_t steps_due = 0;  // rows: every due step has one
  std::int64_t captured = 0, held = 0, skipped = 0, missed = 0, failed = 0, pending = 0;
  std::int64_t partial = 0;              // not a decision: 0 < shots_captured < shots_due
  std::int64_t captured_after_hold = 0;  // waited for the light, then shot
  std::int64_t retried = 0;              // captured at a second or later attempt
  std::int64_t manual = 0;
  Nanoseconds held_total{};
  std::int64_t frames = 0, bytes = 0;
  std::vector<std::pair<std::string, std::vector<ReasonCount>>> reasons;  // by decision
  std::vector<std::pair<std::string, std::int64_t>> light_verdicts;       // verdict, rows
  double gain_least = 1, gain_most = 1;  // of the corrections that were stored
  std::vector<db::EventRow> events;
};

RunReport reportRun(const db::ArchiveReader& archive, const std::string& run_id);

struct ReportPicture {
  std::string title, path;  // relative to the report; .mp4 becomes a player in HTML
};
std::string reportMarkdown(const RunReport& report, const std::vector<ReportPicture>& pictures);
// One self-contained page but for the pictures; text is escaped, no script.
std::string reportHtml(const RunReport& report, const std::vector<ReportPicture>& pictures);

}  // namespace patina::workflow
