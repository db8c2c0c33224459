// SPDX-License-Identifier: GPL-3.0-or-later
// Conditions that a person should know of: one event when they begin, one when they end, however
// often they are reported in between.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "processing/image/units.h"

namespace patina::capture {

class Alerts {
 public:
  // Called with "begins: ..." and "over after 40min: ...".
  using Sink = std::function<void(UtcTime, const std::string& detail)>;
  explicit Alerts(Sink sink) : sink_(std::move(sink)) {}

  void raise(const std::string& what, const std::string& detail, UtcTime utc);
  void clear(const std::string& what, UtcTime utc);
  bool raised(const std::string& what) const { return since_.count(what) != 0; }

 private:
  Sink sink_;
  std::map<std::string, UtcTime> since_;
};

}  // namespace patina::capture
