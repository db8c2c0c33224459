// SPDX-License-Identifier: GPL-3.0-or-later
// The frames of a run as plain files for other programs, each named by when and how it was taken.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "db/archive_reader.h"
#include "processing/image/progress.h"

namespace patina::workflow {

struct ExportOptions {
  // Hard links to the archive's own files where the file system allows it. Both become read-only:
  // a program that wrote into one would change the other.
  bool link = false;
  bool sidecars =
      false;  // also name.ext.xmp: time, exposure, ISO, f-number, camera, as the rows say
};

struct ExportReport {
  std::string run_id;
  std::int64_t frames = 0, written = 0, linked = 0;  // the rest was there
  std::uint64_t bytes_written = 0;
  std::vector<std::string> problems;  // frames that are missing or damaged: not exported
};

// "20240501T120000.000Z_000012_cam0_key_e0.jpg": UTC, step ("manual" for a manual shot), camera,
// light, exposure; then "_a1" for a second attempt, "_f1" for a second file of a shot.
std::string exportName(const db::ArchiveReader::CapturedFrame& frame);

// Writes the files, read-only, and at the end manifest.csv and SHA256SUMS (sha256sum -c). Again on
// the same folder: only what is not there, also after an interruption, also of a run that goes on.
// While it is at work, UNFINISHED says of which run. Throws WorkflowError(kCannotCreate) when the
// folder holds something else, Stopped, db::ArchiveError.
ExportReport exportFrames(const db::ArchiveReader& reader, const std::string& run_id,
                          const std::filesystem::path& out, const ExportOptions& options,
                          Progress& progress);

}  // namespace patina::workflow
