// SPDX-License-Identifier: GPL-3.0-or-later
// Messages over a stream: a length, the message and, on a wire that strangers may reach, a seal.
//
// Seal: HMAC-SHA256 under a key of this connection and direction, over a count and the message, so
// that none can be forged, changed, repeated or left out. It does not hide pictures.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>

#include "devices/clock.h"
#include "devices/descriptor.h"
#include "devices/result.h"
#include "processing/image/picture_file.h"

namespace patina::devices::host {

using Key = std::array<std::byte, 32>;

struct Seal {
  Key ours{}, theirs{};
  std::uint64_t sent = 0, received = 0;
};

inline constexpr std::uint32_t kMessageMax = 1u << 30;  // bytes

// send() from any thread, receive() from one. Errors: kTimeout; kLost, the other end is gone;
// kCorrupt, what came is no message of ours: nothing after it can be trusted.
class Channel {
 public:
  explicit Channel(Descriptor stream);

  void seal(const Seal& seal) { seal_ = seal; }
  // From now on receive() is a kTimeout also when nothing comes for so long. A long message on a
  // slow wire is no silence.
  void limitSilence(Nanoseconds longest) { silence_max_ = longest; }
  Result<void> send(std::span<const std::byte> message, MonoTime deadline);
  // Of kMessageMax bytes at most, or of `most`. A deadline that has passed still takes what came.
  Result<Bytes> receive(MonoTime deadline, std::uint32_t most = kMessageMax);

  int fd() const { return stream_.fd(); }

 private:
  Result<void> sendAll(std::span<const std::byte> bytes, MonoTime deadline);
  Result<void> receiveAll(std::span<std::byte> bytes, MonoTime deadline);

  Descriptor stream_;
  RealClock clock_;
  std::mutex sending_;
  std::optional<Seal> seal_;
  std::optional<Nanoseconds> silence_max_;
};

// Both ends of a connection inside this machine.
struct ChannelEnds {
  Descriptor ours, theirs;
};
Result<ChannelEnds> makeChannelEnds();

}  // namespace patina::devices::host
