// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/scrub_rounds.h"

#include <algorithm>
#include <sstream>

namespace patina::db::care {

ScrubRounds ScrubRounds::parse(const std::string& text) {
  ScrubRounds rounds;
  std::istringstream in(text);
  Range range;
  std::int64_t at = 0;
  while (in >> range.first >> range.last >> at)
    if (range.first >= 1 && range.first <= range.last) rounds.checked(range, utcFromNs(at));
  return rounds;
}

std::string ScrubRounds::text() const {
  std::ostringstream out;
  for (const Checked& c : ranges_)
    out << c.range.first << ' ' << c.range.last << ' ' << toNs(c.at) << '\n';
  return out.str();
}

std::vector<Range> ScrubRounds::unchecked(std::int64_t last_id) const {
  std::vector<Range> gaps;
  std::int64_t next = 1;
  for (const Checked& c : ranges_) {
    if (c.range.first > last_id) break;
    if (next < c.range.first) gaps.push_back({next, c.range.first - 1});
    next = c.range.last + 1;
  }
  if (next <= last_id) gaps.push_back({next, last_id});
  return gaps;
}

std::vector<Range> ScrubRounds::due(std::int64_t last_id) const {
  std::vector<Range> ranges = unchecked(last_id);
  auto by_age = ranges_;
  std::ranges::stable_sort(by_age, {}, &Checked::at);
  for (const Checked& c : by_age)
    if (c.range.first <= last_id)
      ranges.push_back({c.range.first, std::min(c.range.last, last_id)});
  return ranges;
}

void ScrubRounds::checked(Range range, UtcTime at) {
  std::vector<Checked> rest;
  for (const Checked& c : ranges_) {
    if (c.range.first < range.first)
      rest.push_back({{c.range.first, std::min(c.range.last, range.first - 1)}, c.at});
    if (c.range.last > range.last)
      rest.push_back({{std::max(c.range.first, range.last + 1), c.range.last}, c.at});
  }
  rest.push_back({range, at});
  std::ranges::sort(rest, {}, [](const Checked& c) { return c.range.first; });
  ranges_.clear();
  for (const Checked& c : rest) {
    const bool joins = !ranges_.empty() && ranges_.back().at == c.at &&
                       ranges_.back().range.last + 1 == c.range.first;
    if (joins)
      ranges_.back().range.last = c.range.last;
    else
      ranges_.push_back(c);
  }
}

UtcTime ScrubRounds::oldest() const {
  const auto found = std::ranges::min_element(ranges_, {}, &Checked::at);
  return found == ranges_.end() ? UtcTime{} : found->at;
}

}  // namespace patina::db::care
