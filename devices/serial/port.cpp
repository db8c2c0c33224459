// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/serial/port.h"

#include <map>
#include <mutex>
#include <utility>

#include "devices/serial/termios_port.h"

namespace patina::devices::serial {

using namespace std::chrono_literals;

PortSettings takePort(Settings& settings, const std::string& path) {
  PortSettings port;
  port.path = path;
  port.baud = std::stoi(settings.takeChoice("baud", baudRates()));
  port.boot = settings.takeDuration("boot", 0s, 30s, 0s);
  if (path.empty() || path.front() != '/')
    settings.reject("address",
                    "'" + path +
                        "' is no path; use the name in /dev/serial/by-id, which stays the "
                        "same after a replug");
  return port;
}

std::shared_ptr<Port> sharedPort(const PortSettings& wanted, Settings& settings, Clock& clock) {
  struct Known {
    PortSettings settings;
    std::weak_ptr<Port> port;
  };
  static std::mutex mutex;
  static std::map<std::pair<std::string, Clock*>, Known> ports;
  const std::lock_guard lock(mutex);
  Known& known = ports[{wanted.path, &clock}];
  auto port = known.port.lock();
  if (!port) {
    known.settings = wanted;
    known.port = port = makeTermiosPort(wanted, clock);
  } else if (known.settings.baud != wanted.baud || known.settings.boot != wanted.boot) {
    settings.reject("baud", "another device has " + wanted.path + " with other baud or boot");
  } else if (known.settings.lines_are_outputs != wanted.lines_are_outputs) {
    settings.reject(
        "line", "another device speaks over " + wanted.path + ": its control lines are no outputs");
  }
  return port;
}

}  // namespace patina::devices::serial
