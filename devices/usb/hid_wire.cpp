// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/hid_wire.h"

#include <fcntl.h>
#include <linux/hidraw.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "devices/descriptor.h"

namespace patina::devices::usb {
namespace {

using Numbered = std::array<std::uint8_t, 9>;  // the report's number, then the report

tl::unexpected<Error> broken(const std::filesystem::path& node, int error) {
  const std::string what = node.string() + ": " + std::strerror(error);
  if (error == EACCES || error == EPERM)
    return fail(Errc::kLost,
                what + ": install packaging/udev/70-patina.rules and be of the group patina");
  if (error == ETIMEDOUT) return fail(Errc::kTimeout, what);
  return fail(Errc::kLost, what + ": was it unplugged?");
}

class Hidraw final : public HidWire {
 public:
  Hidraw(std::filesystem::path node, Descriptor fd) : node_(std::move(node)), fd_(std::move(fd)) {}

  Result<FeatureReport> feature() override {
    Numbered bytes{};
    const int n = ioctl(fd_.fd(), HIDIOCGFEATURE(sizeof bytes), bytes.data());
    if (n < 0) return broken(node_, errno);
    if (n < static_cast<int>(bytes.size()))
      return fail(Errc::kCorrupt, node_.string() + ": a report of " + std::to_string(n) + " bytes");
    FeatureReport report{};
    std::copy(bytes.begin() + 1, bytes.end(), report.begin());
    return report;
  }
  Result<void> setFeature(const FeatureReport& report) override {
    Numbered bytes{};
    std::ranges::copy(report, bytes.begin() + 1);
    if (ioctl(fd_.fd(), HIDIOCSFEATURE(sizeof bytes), bytes.data()) < 0)
      return broken(node_, errno);
    return {};
  }

 private:
  const std::filesystem::path node_;
  const Descriptor fd_;
};

}  // namespace

Result<std::unique_ptr<HidWire>> openHidraw(const std::filesystem::path& node) {
  Descriptor fd(open(node.c_str(), O_RDWR | O_CLOEXEC));
  if (fd.fd() < 0) return broken(node, errno);
  return std::unique_ptr<HidWire>(std::make_unique<Hidraw>(node, std::move(fd)));
}

}  // namespace patina::devices::usb
