// SPDX-License-Identifier: GPL-3.0-or-later
// What a driver has learned of its device, for the process that comes after its own. A driver that
// was killed need not learn it again; nothing is lost when a note is.
#pragma once

#include <optional>
#include <string>

namespace patina::devices {

// Names the folder of the notes, which outlives the process and not the boot. Where it is unset, as
// in a process that nobody hosts, there are none.
inline constexpr const char* kDriverNotes = "PATINA_DRIVER_NOTES";

// `name` of any letters. A note is whole or not there.
std::optional<std::string> driverNote(const std::string& name);
void noteForDriver(const std::string& name, const std::string& text);

}  // namespace patina::devices
