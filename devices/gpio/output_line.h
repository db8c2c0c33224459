// SPDX-License-Identifier: GPL-3.0-or-later
// One GPIO line as an output: the seam above libgpiod.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "devices/result.h"

namespace patina::devices::gpio {

struct LineName {
  std::string chip;  // label ("pinctrl-bcm2711"), which stays, or name ("gpiochip0")
  std::string line;  // its offset ("17") or its name ("GPIO17")
  bool active_low = false;
};

// Requested for this process while it lives; let go inactive.
class OutputLine {
 public:
  virtual ~OutputLine() = default;
  // And reads back: kRefused when the pin does not follow (a short).
  virtual Result<void> set(bool active) = 0;
};
using RequestLine = std::function<Result<std::unique_ptr<OutputLine>>(const LineName&)>;

// By libgpiod, as "patina", inactive. kLost with the chips that are there; kBusy with who has it.
Result<std::unique_ptr<OutputLine>> requestLine(const LineName& name);

struct Chip {
  std::string name, label;
  unsigned lines = 0;
  std::string trouble;  // why it cannot be opened
};
std::vector<Chip> chips();

}  // namespace patina::devices::gpio
