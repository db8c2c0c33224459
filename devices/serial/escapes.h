// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

namespace patina::devices::serial {

// "ON\r\n" "\xA0\x01": the escapes \r \n \t \0 \\ \xHH. Nothing when one is none of them.
std::optional<std::string> unescape(const std::string& text);
// The other way, for messages: one line whatever a device said, cut at 60 bytes.
std::string escape(const std::string& bytes);

}  // namespace patina::devices::serial
