// SPDX-License-Identifier: GPL-3.0-or-later
// What happened, in order, as one hash: two rehearsals of one plan with one seed must agree.
// Only decisions, verdicts and frames count; no wall time of the real run enters.
#pragma once

#include <span>
#include <string>

#include "db/rows.h"
#include "processing/image/sha256.h"

namespace patina::capture {

class EventLog {
 public:
  void step(const db::StepRow& step);
  void frame(const db::ShotRow& shot, const db::FrameRow& frame);
  void checks(std::span<const db::LightCheckRow> rows);
  std::string finish();  // hex; once

 private:
  void line(const std::string& text);
  Sha256Stream hash_;
};

}  // namespace patina::capture
