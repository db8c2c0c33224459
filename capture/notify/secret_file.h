// SPDX-License-Identifier: GPL-3.0-or-later
// One line that nobody else may read: a token, a password, an address that is its own key.
#pragma once

#include <filesystem>
#include <string>

namespace patina::capture::notify {

// Without its end of line. NotifyError (kConfig, kPermission) when it is not there, is not a
// regular file of one printable line of at most 4 KiB, or others may read it. No message repeats
// what it holds.
std::string readSecret(const std::filesystem::path& file);

}  // namespace patina::capture::notify
