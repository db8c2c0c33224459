// SPDX-License-Identifier: GPL-3.0-or-later
// What `patina archive scrub`, a process of its own, has found since we looked last.
#pragma once

#include <vector>

#include "db/archive_reader.h"

namespace patina::daemon {

// Thread-bound.
class ScrubWatch {
 public:
  // Damage that was found since the last call; the first call gives what was found since the last
  // slice that met none.
  std::vector<db::EventRow> news(const db::ArchiveReader& reader);

 private:
  db::RowId lowest_seen_ = 0;
};

}  // namespace patina::daemon
