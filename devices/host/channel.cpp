// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/channel.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "devices/host/seal.h"

namespace patina::devices::host {
namespace {

constexpr std::size_t kLengthBytes = 4;

auto lost(const std::string& why) { return fail(Errc::kLost, "connection to its driver: " + why); }

// Waits until the stream can be read or written; an error of the stream counts as ready.
Result<void> waitFor(int fd, short what, const Clock& clock, MonoTime deadline) {
  while (true) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - clock.mono()).count();
    pollfd ready{fd, what, 0};
    const int count = poll(&ready, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 60'000)));
    if (count > 0) return {};
    if (count < 0 && errno != EINTR) return lost(std::strerror(errno));
    if (count == 0 && left <= 0) return fail(Errc::kTimeout, "its driver has not answered in time");
  }
}

bool again(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

}  // namespace

Channel::Channel(Descriptor stream) : stream_(std::move(stream)) {
  const int flags = fcntl(stream_.fd(), F_GETFL);
  if (flags >= 0) fcntl(stream_.fd(), F_SETFL, flags | O_NONBLOCK);
}

Result<void> Channel::sendAll(std::span<const std::byte> bytes, MonoTime deadline) {
  while (!bytes.empty()) {
    const ssize_t n = ::send(stream_.fd(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    } else if (again(errno)) {
      if (auto ready = waitFor(stream_.fd(), POLLOUT, clock_, deadline); !ready) return ready;
    } else {
      return lost(std::strerror(errno));
    }
  }
  return {};
}

Result<void> Channel::receiveAll(std::span<std::byte> bytes, MonoTime deadline) {
  while (!bytes.empty()) {
    const ssize_t n = recv(stream_.fd(), bytes.data(), bytes.size(), 0);
    if (n > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    } else if (n == 0) {
      return lost("closed");
    } else if (again(errno)) {
      const MonoTime by =
          silence_max_ ? std::min(deadline, clock_.mono() + *silence_max_) : deadline;
      if (auto ready = waitFor(stream_.fd(), POLLIN, clock_, by); !ready) return ready;
    } else {
      return lost(std::strerror(errno));
    }
  }
  return {};
}

Result<void> Channel::send(std::span<const std::byte> message, MonoTime deadline) {
  if (message.size() > kMessageMax) return fail(Errc::kCorrupt, "a message is too long to send");
  const std::lock_guard lock(sending_);
  std::array<std::byte, kLengthBytes> length{};
  for (std::size_t i = 0; i < kLengthBytes; ++i)
    length[i] = static_cast<std::byte>(message.size() >> (8 * i) & 0xff);
  if (auto sent = sendAll(length, deadline); !sent) return sent;
  if (auto sent = sendAll(message, deadline); !sent) return sent;
  if (!seal_) return {};
  return sendAll(sealOf(seal_->ours, seal_->sent++, message), deadline);
}

Result<Bytes> Channel::receive(MonoTime deadline, std::uint32_t most) {
  std::array<std::byte, kLengthBytes> length{};
  if (auto got = receiveAll(length, deadline); !got) return tl::make_unexpected(got.error());
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < kLengthBytes; ++i)
    size |= std::to_integer<std::uint32_t>(length[i]) << (8 * i);
  if (size > most) return fail(Errc::kCorrupt, "its driver sent a message that is too long");
  Bytes message;
  while (message.size() < size) {  // grown as it comes: a length alone costs no memory
    const std::size_t had = message.size();
    message.resize(std::min<std::size_t>(size, had + (1u << 20)));
    if (auto got = receiveAll(std::span(message).subspan(had), deadline); !got)
      return tl::make_unexpected(got.error());
  }
  if (seal_) {
    Key tag{};
    if (auto got = receiveAll(tag, deadline); !got) return tl::make_unexpected(got.error());
    if (!sameKey(tag, sealOf(seal_->theirs, seal_->received++, message)))
      return fail(Errc::kCorrupt, "a message came whose seal is not the shared key's");
  }
  return message;
}

Result<ChannelEnds> makeChannelEnds() {
  int fds[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fds) != 0)
    return lost(std::string("cannot be made: ") + std::strerror(errno));
  return ChannelEnds{Descriptor(fds[0]), Descriptor(fds[1])};
}

}  // namespace patina::devices::host
