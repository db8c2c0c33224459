// SPDX-License-Identifier: GPL-3.0-or-later
// A serial line as its devices see it: lines of text, and the two control lines as outputs.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "devices/clock.h"
#include "devices/result.h"
#include "devices/settings.h"

namespace patina::devices::serial {

enum class ControlLine { kRts, kDtr };

// Several devices of one process may share a port, from any threads. A port that is lost, or was
// never opened, answers kLost until open() works.
class Port {
 public:
  virtual ~Port() = default;
  virtual Result<void> open() = 0;  // idempotent; unread input is thrown away
  // Throws unread input away, writes `command` (may be empty) and answers the lines that come
  // after it, one a call, without their ends; empty lines are passed over.
  virtual Result<void> send(std::string_view command, MonoTime deadline) = 0;
  virtual Result<std::string> readLine(MonoTime deadline) = 0;
  // As send, then lines until one holds `expected`; what came last when none does.
  virtual Result<std::string> ask(std::string_view command, std::string_view expected,
                                  MonoTime deadline) = 0;
  virtual Result<void> setLine(ControlLine line, bool asserted) = 0;
};

struct PortSettings {
  std::string path;  // a name that is the same after a replug: /dev/serial/by-id/...
  int baud = 9600;
  Nanoseconds boot{};  // after opening: boards that restart with DTR
  // Closing lets the lines go, and with them what hangs on them, also when the process is killed.
  bool lines_are_outputs = false;
};
// baud, boot. `path` is the spec's address.
PortSettings takePort(Settings& settings, const std::string& path);

// The one port of a path in this process; opens nothing. Clock outlives it. Two users that want
// other settings: ConfigError in the words of `settings`.
std::shared_ptr<Port> sharedPort(const PortSettings& wanted, Settings& settings, Clock& clock);

}  // namespace patina::devices::serial
