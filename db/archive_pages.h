// SPDX-License-Identifier: GPL-3.0-or-later
// Long answers in pieces: a run of a year has a million rows, and who asks over the network must
// not decide how much memory we take.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "db/archive.h"

namespace patina::db {

constexpr int kPageRowsMax = 1000;

// Thread-bound like its reader, which must outlive it. A page begins behind `after`, which is the
// number of a step, else the id of a row; a page shorter than its limit is the last.
class ArchivePages {
 public:
  explicit ArchivePages(const ArchiveReader& reader) : reader_(reader) {}

  struct Page {
    std::int64_t after = -1;
    int rows = 100;  // 1 to kPageRowsMax, cut to that
  };
  struct ShotFrame {
    ShotRow shot;
    FrameRow frame;
  };
  std::vector<StepRow> steps(const std::string& run_id, const Page& page) const;
  std::vector<StepRow> stepsByHand(const std::string& run_id, int rows) const;
  std::vector<ShotFrame> frames(const std::string& run_id, const Page& page) const;
  std::vector<LightCheckRow> lightChecks(const std::string& run_id, const Page& page) const;
  std::vector<EventRow> events(const std::string& run_id, const Page& page) const;
  std::vector<DeviceRow> devices() const;
  std::optional<FrameRow> frameOf(const Sha256& sha256) const;  // any of those with these bytes

 private:
  const ArchiveReader& reader_;
};

}  // namespace patina::db
