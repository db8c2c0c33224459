// SPDX-License-Identifier: GPL-3.0-or-later
// A device node below the real system calls: its ioctls are answered by a test (umockdev).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace patina::testing {

// An errno, negative, or what the ioctl returns. `bytes`: what its argument points to, to be
// changed in place; of a control transfer, the data.
struct MockCall {
  unsigned long request = 0;
  std::vector<std::uint8_t> setup;  // of a control transfer: type, request, value, index, length
  std::span<std::uint8_t> bytes;
};
constexpr int kNeverAnswer = -9999;
using MockAnswer = std::function<int(const MockCall&)>;

bool underUmockdev();  // else nothing here works

class MockNode {
 public:
  // USB device 1-1, /dev/bus/usb/001/002.
  static MockNode usb(MockAnswer answer);
  // /dev/hidraw0
  static MockNode hidraw(MockAnswer answer);
  ~MockNode();
  MockNode(MockNode&&) noexcept;

  struct Bed;

 private:
  explicit MockNode(std::unique_ptr<Bed> bed);
  std::unique_ptr<Bed> bed_;
};

}  // namespace patina::testing
