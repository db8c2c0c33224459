// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/stream.h"

#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <cerrno>

namespace patina::devices::v4l2 {
namespace {

using namespace std::chrono_literals;

// A driver that says there is a frame and has none must not cost a whole processor.
constexpr Nanoseconds kAfterFalseAlarm = 2ms;
constexpr std::size_t kDrainedMost = 64;  // of one drain; a fast camera fills while it lasts

v4l2_buffer emptyBuffer(std::uint32_t index = 0) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

Result<std::unique_ptr<Stream>> Stream::start(const Node& node, Clock& clock, int buffers) {
  std::unique_ptr<Stream> stream(new Stream(node, clock));
  if (auto shared = stream->share(buffers); !shared) return tl::make_unexpected(shared.error());
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (auto on = node.call(VIDIOC_STREAMON, &type, "start the stream"); !on)
    return tl::make_unexpected(on.error());
  stream->on_ = true;
  return stream;
}

Stream::~Stream() {
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (on_) node_.ask(VIDIOC_STREAMOFF, &type);
  for (const auto& buffer : buffers_) munmap(buffer.data(), buffer.size());
  v4l2_requestbuffers none{};
  none.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  none.memory = V4L2_MEMORY_MMAP;
  node_.ask(VIDIOC_REQBUFS, &none);
}

Result<void> Stream::share(int buffers) {
  v4l2_requestbuffers request{};
  request.count = static_cast<std::uint32_t>(buffers);
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (auto done = node_.call(VIDIOC_REQBUFS, &request, "ask for buffers"); !done) return done;
  if (request.count < 2)
    return fail(Errc::kRefused, node_.who() + ": the driver has no memory for two pictures");
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = emptyBuffer(i);
    if (auto done = node_.call(VIDIOC_QUERYBUF, &buffer, "ask where a buffer is"); !done)
      return done;
    void* at = mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, node_.fd(),
                    static_cast<off_t>(buffer.m.offset));
    if (at == MAP_FAILED) return node_.failed("map a buffer", errno);
    buffers_.emplace_back(static_cast<std::byte*>(at), buffer.length);
    if (auto done = queue(i); !done) return done;
  }
  return {};
}

Result<void> Stream::queue(std::uint32_t index) {
  v4l2_buffer buffer = emptyBuffer(index);
  return node_.call(VIDIOC_QBUF, &buffer, "give a buffer back");
}

Result<void> Stream::giveBack(const Filled& filled) { return queue(filled.index); }

Result<std::optional<Filled>> Stream::take() {
  v4l2_buffer buffer = emptyBuffer();
  const int error = node_.ask(VIDIOC_DQBUF, &buffer);
  if (error == EAGAIN) return std::optional<Filled>{};
  if (error != 0) return node_.failed("take a frame", error);
  if (buffer.index >= buffers_.size())
    return fail(Errc::kLost, node_.who() + ": the driver named a buffer that is not there");
  Filled filled;
  filled.index = buffer.index;
  filled.sequence = buffer.sequence;
  filled.bytes_used = buffer.bytesused;
  const auto& memory = buffers_[buffer.index];
  filled.bytes = memory.first(std::min<std::size_t>(memory.size(), buffer.bytesused));
  filled.stamp.at = std::chrono::seconds(buffer.timestamp.tv_sec) +
                    std::chrono::microseconds(buffer.timestamp.tv_usec);
  filled.stamp.start_of_frame =
      (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  filled.stamp_is_monotonic =
      (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  filled.damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0;
  return std::optional<Filled>(filled);
}

void Stream::waitReadable(MonoTime deadline) {
  const Nanoseconds left = deadline - clock_.mono();
  // Up, so that a poll of nothing does not come before the deadline; in pieces, since poll's clock
  // stands still in suspend.
  const auto ms = std::clamp<std::int64_t>((left.count() + 999'999) / 1'000'000, 0, 1000);
  pollfd waiting{node_.fd(), POLLIN, 0};
  poll(&waiting, 1, static_cast<int>(ms));
}

Result<std::optional<Filled>> Stream::next(MonoTime deadline) {
  for (bool waited = false;; waited = true) {
    auto filled = take();
    if (!filled || *filled) return filled;
    if (clock_.mono() >= deadline) return std::optional<Filled>{};
    if (waited) clock_.sleepUntil(std::min(deadline, clock_.mono() + kAfterFalseAlarm), {});
    waitReadable(deadline);
  }
}

Result<int> Stream::drain() {
  int drained = 0;
  for (; drained < static_cast<int>(kDrainedMost); ++drained) {
    const auto filled = take();
    if (!filled) return tl::make_unexpected(filled.error());
    if (!*filled) break;
    if (auto back = giveBack(**filled); !back) return tl::make_unexpected(back.error());
  }
  return drained;
}

}  // namespace patina::devices::v4l2
