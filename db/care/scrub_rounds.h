// SPDX-License-Identifier: GPL-3.0-or-later
// When which frame was checked last, by ranges of ids: frames are checked in order of id, so a few
// ranges tell all. Pure. Internal to db/care/.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "processing/image/units.h"

namespace patina::db::care {

struct Range {
  std::int64_t first = 1, last = 0;  // both in it
  bool operator==(const Range&) const = default;
};

class ScrubRounds {
 public:
  static ScrubRounds parse(const std::string& text);  // what cannot be read counts as unchecked
  std::string text() const;

  // What a slice has to look at, in order, up to `last_id`: never checked, then oldest first.
  std::vector<Range> due(std::int64_t last_id) const;
  void checked(Range range, UtcTime at);

  std::vector<Range> unchecked(std::int64_t last_id) const;
  UtcTime oldest() const;  // of the ranges there are; the epoch when there is none

 private:
  struct Checked {
    Range range;
    UtcTime at;
  };
  std::vector<Checked> ranges_;  // sorted, apart
};

}  // namespace patina::db::care
