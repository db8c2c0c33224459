// SPDX-License-Identifier: GPL-3.0-or-later
// What an archive holds, for whoever asks.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "db/rows.h"
#include "processing/image/picture_file.h"

namespace patina::db {

// Read side: any process, any time, also while another one captures. Thread-bound, but for the one
// that an Archive gives. Long answers in pieces: archive_pages.h.
class ArchiveReader {
 public:
  explicit ArchiveReader(const std::filesystem::path& folder);  // ArchiveError if there is none
  ~ArchiveReader();
  ArchiveReader(ArchiveReader&&) noexcept;

  const std::filesystem::path& folder() const;
  std::vector<RunRow> runs() const;                              // in the order they were added
  RunRow findRun(const std::string& id_prefix_or_latest) const;  // kUsage with the choices
  std::vector<StepRow> steps(const std::string& run_id, std::optional<Decision> = {}) const;
  std::optional<StepRow> step(const std::string& run_id, std::int64_t number) const;
  std::vector<ShotRow> shotsOfStep(RowId step_id) const;
  std::vector<FrameRow> framesOfStep(RowId step_id) const;
  std::optional<FrameRow> newestFrame(const std::string& run_id) const;
  std::vector<FrameRow> framesBetween(const std::string& run_id, UtcTime from, UtcTime to) const;
  std::vector<LightCheckRow> lightChecks(const std::string& run_id) const;
  std::vector<LightCheckRow> lightChecksOfShot(RowId shot_id) const;
  std::vector<ReadingRow> readings(const std::string& run_id) const;
  std::vector<EventRow> events(const std::string& run_id) const;
  std::vector<CalibrationRow> calibrations(const std::string& kind = {}) const;
  std::vector<ProductRow> products(const std::string& kind = {}) const;
  // Every captured shot of a run with its frame and step, in order of step; streamed.
  struct CapturedFrame {
    StepRow step;
    ShotRow shot;
    FrameRow frame;
  };
  void eachFrame(const std::string& run_id, const std::function<void(const CapturedFrame&)>&) const;

  std::filesystem::path pathOf(const FrameRow& frame) const;
  Bytes read(const FrameRow& frame) const;  // checks the hash: kBadData when it does not match

  struct State;  // of db/ itself

 private:
  friend class Archive;
  friend class ArchivePages;
  explicit ArchiveReader(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace patina::db
