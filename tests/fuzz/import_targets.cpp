// SPDX-License-Identifier: GPL-3.0-or-later
// What comes in with pictures of others: directions of lights (.lp), the times in the names of
// files, and the facts of a product, which are JSON.
#include <algorithm>
#include <sstream>

#include "capture/workflow/facts.h"
#include "capture/workflow/lights_file.h"
#include "capture/workflow/picture_times.h"
#include "processing/image/failure.h"
#include "tests/fuzz/targets.h"

namespace patina::testing {

void fuzzLights(std::span<const std::byte> bytes) {
  try {
    workflow::parseLights(textOf(bytes), "dirs.lp");
  } catch (const Failure&) {
    // Refused, with the line.
  }
}

// Every line is a name.
void fuzzPictureNames(std::span<const std::byte> bytes) {
  const UtcTime origin = parseUtc("2024-05-01T12:00:00Z");
  std::istringstream lines(textOf(bytes));
  std::vector<std::string> names;
  for (std::string line; std::getline(lines, line) && names.size() < 500;) names.push_back(line);
  std::sort(names.begin(), names.end(), workflow::naturalLess);
  std::vector<UtcTime> times;
  for (const std::string& name : names) {
    PATINA_CHECK(!workflow::naturalLess(name, name));
    if (const auto time = workflow::timeFromName(name, origin)) times.push_back(*time);
  }
  std::sort(times.begin(), times.end());
  const workflow::Rhythm rhythm = workflow::findRhythm(times);
  PATINA_CHECK(rhythm.numbers.size() == times.size());
  PATINA_CHECK(!rhythm.regular || rhythm.interval > Nanoseconds{});
}

void fuzzProductFacts(std::span<const std::byte> bytes) {
  try {
    const std::string once = workflow::Facts::parse(textOf(bytes)).json();
    PATINA_CHECK(workflow::Facts::parse(once).json() == once);
  } catch (const Failure&) {
    // No JSON object.
  }
}

}  // namespace patina::testing
