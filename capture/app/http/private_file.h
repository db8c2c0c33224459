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
// file, a link, or open to anybody but its owner; kPermission when it may not be read.
std::optional<std::string> readPrivateFile(const std::filesystem::path& file,
                                           std::size_t bytes_max);

// Text of a PEM file, which may be a link, as certificate tools make them. A key that everybody
// may read is HttpError(kConfig), as is a file that is not there; its group may read it.
std::string readCertificate(const std::filesystem::path& file);
std::string readKey(const std::filesystem::path& file);

}  // namespace patina::http
