// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures that somebody else took become a run of the archive.
//
// Picture files are stored byte for byte, frames of a GIF or film as PNG in order (the container's
// hash in an event). A place in the rhythm without a picture is a missed step. A file that does not
// decode is quarantined and named; its step has failed. Interrupted, the same import goes on where
// it stopped; repeated, it is refused unless a second run is asked for.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capture/workflow/import_listing.h"
#include "processing/image/progress.h"

namespace patina::workflow {

struct ImportOptions {
  ListingOptions listing;
  std::filesystem::path archive;
  std::string specimen, process, licence, description;
  bool again = false;  // a second run of the same pictures
  std::string owner;   // named in the archive's lock
};
struct RejectedFile {
  std::string file, why;
};
struct ImportReport {
  std::string run_id;
  bool resumed = false;
  Nanoseconds interval{};
  UtcTime first_utc, last_utc;
  std::int64_t steps = 0, captured = 0, missed = 0, failed = 0, frames = 0;
  SizePx smallest, largest;               // least and greatest of each side
  int sizes = 0;                          // how many different ones
  std::vector<RejectedFile> rejected;     // quarantined
  std::vector<std::string> without_time;  // left where they are
};

// Takes the archive's lock (db::ArchiveError kTemporary names the owner). Throws WorkflowError
// (kBadData) when not one picture was usable: the run is then aborted. Decodes in parallel, a few
// pictures at a time.
ImportReport importPictures(const ImportOptions& options, const std::function<UtcTime()>& now,
                            Progress& progress);

}  // namespace patina::workflow
