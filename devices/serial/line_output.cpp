// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/serial/line_output.h"

#include "devices/serial/escapes.h"

namespace patina::devices::serial {

std::optional<LineOutput> takeLine(Settings& settings, const std::string& key) {
  const std::string line = settings.takeChoice(key, {"", "rts", "dtr"});
  const bool high = settings.takeChoice("active", {"high", "low"}) == "high";
  if (line.empty()) return std::nullopt;
  return LineOutput{line == "rts" ? ControlLine::kRts : ControlLine::kDtr, high};
}

std::string takeBytes(Settings& settings, const std::string& key) {
  const auto bytes = unescape(settings.takeText(key, ""));
  if (!bytes) settings.reject(key, R"(has an escape that is none of \r \n \t \0 \\ \xHH)");
  return *bytes;
}

std::shared_ptr<Port> portFor(std::shared_ptr<Port> given, Settings& settings,
                              const std::string& path, bool lines_are_outputs, Clock& clock) {
  PortSettings wanted = takePort(settings, path);
  wanted.lines_are_outputs = lines_are_outputs;
  return given ? std::move(given) : sharedPort(wanted, settings, clock);
}

}  // namespace patina::devices::serial
