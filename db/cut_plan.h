// SPDX-License-Identifier: GPL-3.0-or-later
// Which of the unsynced changes a power cut takes: a pure function of them and a seed.
#pragma once

#include <cstdint>
#include <vector>

#include "db/unsynced.h"

namespace patina::db {

// What happens to one file. A disk writes in sectors, so every sector keeps its own number of
// changes: the first `kept`; one more where the write after those was torn; any number where the
// disk wrote in an order of its own.
struct FileCut {
  std::uint64_t file = 0;
  std::size_t kept = 0;  // of its changes: whole, and the size of the file after them
  enum class Tear { kNone, kTorn, kReordered } tear = Tear::kNone;
  std::int64_t sector = 4096;  // bytes: 512 or 4096
  std::uint64_t seed = 0;

  // Does change `index` survive in the sector at `offset` (a multiple of `sector`)?
  bool survives(std::size_t index, std::int64_t offset) const;
};

struct CutPlan {
  std::vector<FileCut> files;    // those that lose something
  std::vector<UndoEntry> names;  // taken back, newest first
};

// Per file and per folder nothing, all or some prefix survives; of one file in seven any sectors
// do. One cut in eight is the worst case: nothing unsynced survives anywhere.
CutPlan planCut(const Unsynced& unsynced, std::uint64_t seed);

}  // namespace patina::db
