// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/mapped_plane.h"

#include <linux/dma-buf.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <algorithm>
#include <utility>

namespace patina::devices::libcamera {

MappedPlane::MappedPlane(int fd, std::size_t offset, std::size_t length)
    : fd_(fd), offset_(offset), length_(length) {
  void* at = ::mmap(nullptr, offset_ + length_, PROT_READ, MAP_SHARED, fd_, 0);
  if (at != MAP_FAILED) at_ = static_cast<const std::byte*>(at);
}

MappedPlane::MappedPlane(MappedPlane&& other) noexcept
    : fd_(other.fd_),
      offset_(other.offset_),
      length_(other.length_),
      at_(std::exchange(other.at_, nullptr)) {}

MappedPlane::~MappedPlane() {
  if (at_) ::munmap(const_cast<std::byte*>(at_), offset_ + length_);
}

void MappedPlane::appendTo(Bytes& out, std::size_t bytes) const {
  sync(DMA_BUF_SYNC_START);
  out.insert(out.end(), at_ + offset_, at_ + offset_ + std::min(bytes, length_));
  sync(DMA_BUF_SYNC_END);
}

// Caches of processors that need it. What is no DMA buffer refuses, and needs it not.
void MappedPlane::sync(std::uint64_t when) const {
  dma_buf_sync call{DMA_BUF_SYNC_READ | when};
  ::ioctl(fd_, DMA_BUF_IOCTL_SYNC, &call);
}

}  // namespace patina::devices::libcamera
