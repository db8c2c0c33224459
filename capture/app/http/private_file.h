// SPDX-License-Identifier: GPL-3.0-or-later
// Files that only their owner may read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace patina::http {

// Mode 0600 from the first moment, synced, then renamed into place. HttpError(kCannotCreate).
void writePrivateFile(const std::filesystem::path& file, const std::string& text);
// Nothing when it is not there. HttpError(kConfig) when it is larger than `bytes_max`, no regular
// file, or open to others; kPermission when it may not be read.
std::optional<std::string> readPrivateFile(const std::filesystem::path& file,
                                           std::size_t bytes_max);

}  // namespace patina::http
