// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/usb_reset.h"

#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "devices/descriptor.h"
#include "devices/poll_until.h"

namespace patina::devices::usb {
namespace {

// In a forked process: only what is safe there.
[[noreturn]] void resetAndTell(const char* node, int tell) {
  int error = 0;
  const int fd = open(node, O_WRONLY | O_CLOEXEC);
  if (fd < 0 || ioctl(fd, USBDEVFS_RESET, 0) < 0) error = errno;
  [[maybe_unused]] const auto n = write(tell, &error, sizeof error);
  _exit(0);
}

}  // namespace

Result<void> resetDevice(const UsbDevice& device, Clock& clock, MonoTime deadline,
                         const std::filesystem::path& root) {
  const std::string node = (root / device.node()).string();
  const std::string who = "reset of " + device.describe();
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    return fail(Errc::kBusy, who + ": pipe: " + std::strerror(errno));
  const Descriptor read_end(ends[0]);
  Descriptor write_end(ends[1]);
  const pid_t child = fork();
  if (child < 0) return fail(Errc::kBusy, who + ": fork: " + std::strerror(errno));
  if (child == 0) {
    // Twice, so that one stuck in the kernel belongs to init and leaves no corpse with us.
    if (fork() == 0) resetAndTell(node.c_str(), write_end.fd());
    _exit(0);
  }
  while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) continue;
  write_end = Descriptor();
  int error = EIO;
  switch (pollUntil(read_end.fd(), POLLIN, clock, deadline)) {
    case Polled::kTimeout:
      return fail(Errc::kTimeout, who + ": the kernel is still at it at the deadline");
    case Polled::kReady:
      if (read(read_end.fd(), &error, sizeof error) != sizeof error) error = EIO;
      break;
    case Polled::kHungUp:
      break;
  }
  if (error == 0) return {};
  const std::string what = who + ": " + node + ": " + std::strerror(error);
  if (error == EACCES || error == EPERM)
    return fail(Errc::kUnsupported,
                what + ": install packaging/udev/70-patina.rules and be of the group patina");
  return fail(Errc::kLost, what);
}

}  // namespace patina::devices::usb
