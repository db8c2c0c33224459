// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/hub_wire.h"

#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "devices/descriptor.h"

namespace patina::devices::usb {
namespace {

constexpr unsigned kTimeoutMs = 2000;

class UsbfsWire final : public HubWire {
 public:
  explicit UsbfsWire(std::filesystem::path root) : root_(std::move(root)) {}

  Result<std::vector<std::uint8_t>> control(const UsbDevice& hub, const Setup& setup) override {
    const std::string node = (root_ / hub.node()).string();
    const Descriptor fd(open(node.c_str(), O_RDWR | O_CLOEXEC));
    if (fd.fd() < 0) return broken(hub, node, errno);
    std::vector<std::uint8_t> data(setup.length);
    usbdevfs_ctrltransfer transfer{};
    transfer.bRequestType = setup.type;
    transfer.bRequest = setup.request;
    transfer.wValue = setup.value;
    transfer.wIndex = setup.index;
    transfer.wLength = setup.length;
    transfer.timeout = kTimeoutMs;
    transfer.data = data.data();
    const int n = ioctl(fd.fd(), USBDEVFS_CONTROL, &transfer);
    if (n < 0) return broken(hub, node, errno);
    data.resize(static_cast<std::size_t>(n));
    return data;
  }

 private:
  static tl::unexpected<Error> broken(const UsbDevice& hub, const std::string& node, int error) {
    const std::string what = "hub " + hub.describe() + ": " + node + ": " + std::strerror(error);
    if (error == EACCES || error == EPERM)
      return fail(Errc::kUnsupported,
                  what + ": install packaging/udev/70-patina.rules and be of the group patina");
    if (error == ETIMEDOUT) return fail(Errc::kTimeout, what);
    if (error == EPIPE) return fail(Errc::kRefused, what + ": it does not know the request");
    return fail(Errc::kLost, what);
  }

  const std::filesystem::path root_;
};

}  // namespace

std::unique_ptr<HubWire> makeUsbfsWire(std::filesystem::path root) {
  return std::make_unique<UsbfsWire>(std::move(root));
}

}  // namespace patina::devices::usb
