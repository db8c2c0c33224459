// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/guest/dslr_gadget.h"

#include <unistd.h>

namespace patina::testing {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kTransferBytes = 65536;
constexpr int kIn = 1, kOut = 2, kEvents = 3;  // endpoints in the order of their descriptors

// A still image device of PTP's class.
Bytes interfaceOfCamera() {
  Bytes bytes;
  for (const int v : {9, 4, 0,    0, 3,  6, 1, 1, 0,  //
                      7, 5, 0x81, 2, 0,  2, 0,        // 512 bytes a packet
                      7, 5, 0x02, 2, 0,  2, 0,        //
                      7, 5, 0x83, 3, 64, 0, 6})
    bytes.push_back(static_cast<std::byte>(v));
  return bytes;
}

// Moving data the wrong way halts an endpoint of FunctionFS.
void haltIn(int fd) {
  std::byte nothing{};
  [[maybe_unused]] const auto halted = ::read(fd, &nothing, 1);
}
void haltOut(int fd) {
  const std::byte nothing{};
  [[maybe_unused]] const auto halted = ::write(fd, &nothing, 1);
}

}  // namespace

DslrGadget::DslrGadget(devices::twin::dslr::Dslr& camera)
    : camera_(camera),
      ptp_(camera),
      usb_(
          {"dslr", 0x1d6b, 0x0100, "Patina", "Virtual DSLR", camera.options().serial},
          interfaceOfCamera(), 3,
          [this](auto setup, auto data) -> std::optional<Bytes> {
            const std::lock_guard lock(mutex_);
            const UsbTransfer answer = ptp_.control(setup, data);
            if (answer.kind != UsbTransfer::kDone) return std::nullopt;
            return answer.bytes;
          },
          camera.clock()) {
  usb_.onDisable([this] {
    const std::lock_guard lock(mutex_);
    ptp_.reset();
  });
  usb_.serve([this] { serveBulkOut(); });
  usb_.serve([this] { serveBulkIn(); });
  usb_.serve([this] { serveInterrupt(); });
}

void DslrGadget::pause() { camera_.clock().sleepUntil(camera_.clock().mono() + 2ms, {}); }

void DslrGadget::serveBulkOut() {
  Bytes bytes(kTransferBytes);
  const ssize_t n = ::read(usb_.endpoint(kOut), bytes.data(), bytes.size());
  if (n < 0) return pause();  // not plugged in
  bytes.resize(static_cast<std::size_t>(n));
  while (!usb_.stopping()) {
    {
      const std::lock_guard lock(mutex_);
      if (const auto done = ptp_.bulkOut(bytes)) {
        if (done->kind == UsbTransfer::kStalledPipe) haltOut(usb_.endpoint(kOut));
        return;
      }
    }
    pause();
  }
}

void DslrGadget::serveBulkIn() {
  std::optional<UsbTransfer> transfer;
  {
    const std::lock_guard lock(mutex_);
    transfer = ptp_.bulkIn(kTransferBytes);
  }
  if (!transfer) return pause();
  if (transfer->kind == UsbTransfer::kStalledPipe) return haltIn(usb_.endpoint(kIn));
  if (transfer->kind == UsbTransfer::kGone) {
    usb_.unplug();
    usb_.plugIn();
    return;
  }
  [[maybe_unused]] const auto sent =
      ::write(usb_.endpoint(kIn), transfer->bytes.data(), transfer->bytes.size());
}

void DslrGadget::serveInterrupt() {
  std::optional<UsbTransfer> event;
  {
    const std::lock_guard lock(mutex_);
    ptp_.takeEvents();
    event = ptp_.interruptIn(64);
  }
  if (!event) return pause();
  [[maybe_unused]] const auto sent =
      ::write(usb_.endpoint(kEvents), event->bytes.data(), event->bytes.size());
}

}  // namespace patina::testing
