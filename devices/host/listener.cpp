// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/listener.h"

#include <memory>
#include <vector>

#include "devices/host/child_process.h"
#include "devices/host/dial.h"
#include "devices/host/seal.h"

namespace patina::devices::host {

using namespace std::chrono_literals;

Result<void> serveCaller(Channel& channel, const Key& key, const DeviceMaker& make,
                         const DeviceFinder& find, Nanoseconds silence_max) {
  const RealClock clock;
  if (auto met = greetAsHost(channel, key, clock.mono() + 5s); !met) return met;
  serve(channel, make, find, silence_max);
  return {};
}

Result<void> listenForCallers(const ListenOptions& options, std::stop_token stop) {
  const auto listener = listenOn(options.address);
  if (!listener) return tl::make_unexpected(listener.error());
  if (options.on_listening) options.on_listening(portOf(*listener));
  RealClock clock;
  std::vector<std::unique_ptr<ChildProcess>> serving;
  while (clock.sleepUntil(clock.mono() + 50ms, stop) == Wake::kDue) {
    std::erase_if(serving, [](const auto& child) { return child->ended(); });
    while (auto caller = acceptFrom(*listener)) {
      if (static_cast<int>(serving.size()) >= options.callers_max) continue;  // it is hung up on
      if (auto child = ChildProcess::start(options.command, *caller))
        serving.push_back(std::move(*child));
    }
  }
  for (const auto& child : serving) child->kill();
  return {};
}

}  // namespace patina::devices::host
