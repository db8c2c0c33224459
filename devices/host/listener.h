// SPDX-License-Identifier: GPL-3.0-or-later
// Another machine's devices, served over TCP to whoever has the shared key.
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>

#include "devices/host/server.h"

namespace patina::devices::host {

// What came over `channel` from a stranger: serves it once he has shown the key within 5 s. Five
// times a caller is silent when he should have asked, and he is gone: his devices are closed, so
// that he can open them over a new link.
inline constexpr Nanoseconds kCallerSilenceMax = std::chrono::seconds(5);
Result<void> serveCaller(Channel& channel, const Key& key, const DeviceMaker& make,
                         const DeviceFinder& find = {},
                         Nanoseconds silence_max = kCallerSilenceMax);

struct ListenOptions {
  std::string address;               // "0.0.0.0:8461"; port 0: any
  std::vector<std::string> command;  // serves one connection; "--fd 3" is added
  int callers_max = 16;              // more are turned away
  std::function<void(int port)> on_listening;
};
// A process for each connection, until stop. An error only when it cannot listen.
Result<void> listenForCallers(const ListenOptions& options, std::stop_token stop);

}  // namespace patina::devices::host
