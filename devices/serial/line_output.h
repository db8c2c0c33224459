// SPDX-License-Identifier: GPL-3.0-or-later
// Settings that lamps and triggers on a serial port have in common.
#pragma once

#include <optional>
#include <string>

#include "devices/serial/port.h"

namespace patina::devices::serial {

// One control line as an output.
struct LineOutput {
  ControlLine line = ControlLine::kRts;
  bool active_high = true;  // asserted = active

  Result<void> drive(Port& port, bool active) const {
    return port.setLine(line, active == active_high);
  }
};
// `key` = "rts" | "dtr" with `active` = "high" | "low"; nothing when it is not there.
std::optional<LineOutput> takeLine(Settings& settings, const std::string& key);

// The text of `key` with its escapes resolved; empty when it is not there.
std::string takeBytes(Settings& settings, const std::string& key);

// Takes the port of a spec unless one is given.
std::shared_ptr<Port> portFor(std::shared_ptr<Port> given, Settings& settings,
                              const std::string& path, bool lines_are_outputs, Clock& clock);

}  // namespace patina::devices::serial
