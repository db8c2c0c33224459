// SPDX-License-Identifier: GPL-3.0-or-later
// A running stream: a few buffers shared with the driver.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "devices/clock.h"
#include "devices/v4l2/frame_timing.h"
#include "devices/v4l2/node.h"

namespace patina::devices::v4l2 {

// A filled buffer. Its bytes stay until it is given back.
struct Filled {
  std::uint32_t index = 0, sequence = 0;
  std::size_t bytes_used = 0;        // as the driver says, even if that cannot be
  std::span<const std::byte> bytes;  // of the buffer, never more than it holds
  FrameStamp stamp;
  bool stamp_is_monotonic = false;
  bool damaged = false;  // the driver's own word
};

class Stream {
 public:
  // `node` and `clock` outlive it.
  static Result<std::unique_ptr<Stream>> start(const Node& node, Clock& clock, int buffers);
  ~Stream();  // stops it
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  // The oldest filled one; nothing at the deadline.
  Result<std::optional<Filled>> next(MonoTime deadline);
  Result<void> giveBack(const Filled& filled);
  // All that are filled now go back unseen.
  Result<int> drain();

 private:
  Stream(const Node& node, Clock& clock) : node_(node), clock_(clock) {}
  Result<void> share(int buffers);
  Result<void> queue(std::uint32_t index);
  Result<std::optional<Filled>> take();  // at once, or nothing
  void waitReadable(MonoTime deadline);

  const Node& node_;
  Clock& clock_;
  std::vector<std::span<std::byte>> buffers_;
  bool on_ = false;
};

}  // namespace patina::devices::v4l2
