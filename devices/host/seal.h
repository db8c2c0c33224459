// SPDX-License-Identifier: GPL-3.0-or-later
// The shared key of two machines: who is there, and that nothing was changed on the way.
//
// Handshake, each message framed: caller "PATINA-HOST/1" + nonce; host nonce + HMAC(key, "host" +
// both nonces); caller HMAC(key, "caller" + both nonces). A stranger learns nothing of the key and
// gets nothing done. Session keys are HMACs of both nonces, one a direction.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "devices/host/channel.h"

namespace patina::devices::host {

Key sealOf(const Key& key, std::uint64_t count, std::span<const std::byte> message);
bool sameKey(const Key& a, const Key& b);  // in constant time

// The key is the SHA-256 of the file's bytes without white space at its ends: 16 to 4096 of them.
// Throws ConfigError when it is missing, too short or readable by others (mode 0600 or 0400).
Key readKey(const std::filesystem::path& file);

// The channel is sealed afterwards. kRefused: the other side has another key.
Result<void> greetAsCaller(Channel& channel, const Key& key, MonoTime deadline);
Result<void> greetAsHost(Channel& channel, const Key& key, MonoTime deadline);

}  // namespace patina::devices::host
