// SPDX-License-Identifier: GPL-3.0-or-later
// A capturing process in small, for tests that end it without warning, and the judge of what it
// leaves behind. The judge keeps what was acknowledged outside of the archive.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "db/archive.h"

namespace patina::testing {

struct Acked {
  std::string sha256;     // hex
  std::int64_t step = 0;  // -1: not told
  int shot = 0;
  db::RowId shot_id = 0;  // 0: not told
};

// Opens or creates the archive, closes what an earlier life left open, and commits `steps` further
// steps of two shots each, made of noise that depends on `seed` and the step alone. `acked` runs
// after each acknowledgement.
void liveOn(const db::ArchiveOptions& options, std::int64_t steps, std::uint64_t seed,
            const std::function<void(const Acked&)>& acked);

// What an outside process knows of an archive.
class Judge {
 public:
  void note(const Acked& acked) { acked_[acked.sha256] = acked; }
  std::size_t count() const { return acked_.size(); }

  // Broken promises of the newest run, one a line: an acknowledged frame without a row, with two,
  // of another shot or with other bytes; a place in a sweep that was captured twice; a step with
  // two rows, or with none between its neighbours. Reads the catalogue as it lies there.
  std::vector<std::string> judgeCatalogue(const std::filesystem::path& archive) const;

  // The same, and what `verify` says: for an archive that was recovered.
  std::vector<std::string> judgeRecovered(const std::filesystem::path& archive) const;

 private:
  std::map<std::string, Acked> acked_;
};

}  // namespace patina::testing
