// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "devices/serial/port.h"

namespace patina::devices::serial {

// A terminal device of the kernel: 8N1, raw, no flow control, for this process alone.
std::shared_ptr<Port> makeTermiosPort(PortSettings settings, Clock& clock);
const std::vector<std::string>& baudRates();  // as takePort accepts them, the usual one first

// Names that stay the same after a replug; `root` in place of "/".
std::vector<std::filesystem::path> stableNames(const std::filesystem::path& root);

}  // namespace patina::devices::serial
