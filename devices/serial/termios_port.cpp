// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/serial/termios_port.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <optional>
#include <utility>

#include "devices/descriptor.h"
#include "devices/poll_until.h"
#include "devices/serial/escapes.h"

namespace fs = std::filesystem;

namespace patina::devices::serial {
namespace {

constexpr std::size_t kLongestLine = 4096;  // more without an end is no line

struct Rate {
  const char* text;
  speed_t speed;
};
constexpr Rate kRates[] = {{"9600", B9600},     {"1200", B1200},     {"2400", B2400},
                           {"4800", B4800},     {"19200", B19200},   {"38400", B38400},
                           {"57600", B57600},   {"115200", B115200}, {"230400", B230400},
                           {"460800", B460800}, {"921600", B921600}};

speed_t speedOf(int baud) {
  for (const Rate& rate : kRates)
    if (std::to_string(baud) == rate.text) return rate.speed;
  return B9600;
}

std::string attached() {
  std::string list;
  for (const fs::path& name : stableNames("/")) list += (list.empty() ? "" : ", ") + name.string();
  return list.empty() ? "there are no serial devices" : "there are: " + list;
}

class TermiosPort final : public Port {
 public:
  TermiosPort(PortSettings settings, Clock& clock)
      : settings_(std::move(settings)), clock_(clock) {}
  ~TermiosPort() override { closeLocked(); }

  Result<void> open() override {
    const std::lock_guard lock(mutex_);
    if (fd_.fd() >= 0 && !hungUp()) {
      discard();
      return {};
    }
    closeLocked();
    auto opened = openLocked();
    if (!opened) closeLocked();
    return opened;
  }
  Result<void> send(std::string_view command, MonoTime deadline) override {
    const std::lock_guard lock(mutex_);
    return sendLocked(command, deadline);
  }
  Result<std::string> readLine(MonoTime deadline) override {
    const std::lock_guard lock(mutex_);
    return readLineLocked(deadline);
  }
  Result<std::string> ask(std::string_view command, std::string_view expected,
                          MonoTime deadline) override {
    const std::lock_guard lock(mutex_);
    if (auto sent = sendLocked(command, deadline); !sent) return tl::make_unexpected(sent.error());
    std::optional<std::string> last;
    while (true) {
      auto line = readLineLocked(deadline);
      if (!line && line.error().code == Errc::kTimeout && last) return *last;
      if (!line || line->find(expected) != std::string::npos) return line;
      last = *line;
    }
  }
  Result<void> setLine(ControlLine line, bool asserted) override {
    const std::lock_guard lock(mutex_);
    if (fd_.fd() < 0) return notOpen();
    const int bit = line == ControlLine::kRts ? TIOCM_RTS : TIOCM_DTR;
    if (ioctl(fd_.fd(), asserted ? TIOCMBIS : TIOCMBIC, &bit) != 0) return lost("ioctl", errno);
    return {};
  }

 private:
  Result<void> openLocked() {
    fd_ = Descriptor(::open(settings_.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (fd_.fd() < 0) {
      const int error = errno;
      const std::string what = settings_.path + ": " + std::strerror(error);
      if (error == EBUSY) return fail(Errc::kBusy, what + ": another program has it");
      if (error == EACCES)
        return fail(Errc::kLost, what +
                                     ": add this user to the group of the port, or install "
                                     "packaging/udev/70-patina.rules");
      return fail(Errc::kLost, what + ": is it plugged in? " + attached());
    }
    if (flock(fd_.fd(), LOCK_EX | LOCK_NB) != 0)
      return fail(Errc::kBusy, settings_.path + ": another program holds its lock");
    termios mode{};
    if (tcgetattr(fd_.fd(), &mode) != 0)
      return fail(Errc::kLost, settings_.path + " is no serial port");
    cfmakeraw(&mode);
    mode.c_cflag |= CLOCAL | CREAD;
    mode.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB | HUPCL);
    if (settings_.lines_are_outputs) mode.c_cflag |= HUPCL;
    cfsetspeed(&mode, speedOf(settings_.baud));
    if (tcsetattr(fd_.fd(), TCSANOW, &mode) != 0) return lost("tcsetattr", errno);
    ioctl(fd_.fd(), TIOCEXCL);
    // The kernel asserts both on opening: let go at once.
    const int both = TIOCM_RTS | TIOCM_DTR;
    if (settings_.lines_are_outputs && ioctl(fd_.fd(), TIOCMBIC, &both) != 0)
      return fail(Errc::kUnsupported, settings_.path + " has no control lines");
    clock_.sleepUntil(clock_.mono() + settings_.boot, {});
    discard();
    return {};
  }
  void closeLocked() {
    if (fd_.fd() >= 0) ioctl(fd_.fd(), TIOCNXCL);
    fd_ = Descriptor();
    pending_.clear();
  }
  bool hungUp() const {
    pollfd one{fd_.fd(), 0, 0};
    return poll(&one, 1, 0) > 0;
  }
  void discard() {
    tcflush(fd_.fd(), TCIFLUSH);
    pending_.clear();
  }
  tl::unexpected<Error> notOpen() const {
    return fail(Errc::kLost, settings_.path + " is not open: recover first");
  }
  tl::unexpected<Error> lost(const char* call, int error) {
    closeLocked();
    return fail(Errc::kLost, settings_.path + ": " + call + ": " +
                                 (error == 0 ? "hung up" : std::strerror(error)) +
                                 ": was it unplugged?");
  }
  tl::unexpected<Error> late(const char* call) const {
    return fail(Errc::kTimeout, settings_.path + ": " + call + ": nothing by the deadline");
  }

  Result<void> sendLocked(std::string_view command, MonoTime deadline) {
    if (fd_.fd() < 0) return notOpen();
    discard();
    while (!command.empty()) {
      const ssize_t n = write(fd_.fd(), command.data(), command.size());
      if (n > 0) {
        command.remove_prefix(static_cast<std::size_t>(n));
        continue;
      }
      if (n < 0 && errno != EAGAIN && errno != EINTR) return lost("write", errno);
      switch (pollUntil(fd_.fd(), POLLOUT, clock_, deadline)) {
        case Polled::kReady:
          break;
        case Polled::kTimeout:
          return late("write");
        case Polled::kHungUp:
          return lost("write", 0);
      }
    }
    return {};
  }

  Result<std::string> readLineLocked(MonoTime deadline) {
    if (fd_.fd() < 0) return notOpen();
    while (true) {
      if (auto line = takeLine()) return *line;
      if (pending_.size() > kLongestLine) {
        discard();
        return fail(Errc::kCorrupt,
                    settings_.path + ": no end of line in 4096 bytes: is baud right?");
      }
      char bytes[512];
      const ssize_t n = read(fd_.fd(), bytes, sizeof bytes);
      if (n > 0) {
        pending_.append(bytes, static_cast<std::size_t>(n));
        continue;
      }
      if (n < 0 && errno == EINTR) continue;
      if (n == 0 || errno != EAGAIN) return lost("read", n == 0 ? 0 : errno);
      switch (pollUntil(fd_.fd(), POLLIN, clock_, deadline)) {
        case Polled::kReady:
          break;
        case Polled::kTimeout:
          return late("read");
        case Polled::kHungUp:
          return lost("read", 0);
      }
    }
  }
  std::optional<std::string> takeLine() {
    pending_.erase(0, std::min(pending_.find_first_not_of("\r\n"), pending_.size()));
    const auto end = pending_.find_first_of("\r\n");
    if (end == std::string::npos) return std::nullopt;
    std::string line = pending_.substr(0, end);
    pending_.erase(0, end + 1);
    return line;
  }

  const PortSettings settings_;
  Clock& clock_;
  std::mutex mutex_;  // all below
  Descriptor fd_;
  std::string pending_;  // read, not yet a line
};

}  // namespace

std::shared_ptr<Port> makeTermiosPort(PortSettings settings, Clock& clock) {
  return std::make_shared<TermiosPort>(std::move(settings), clock);
}

const std::vector<std::string>& baudRates() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> texts;
    for (const Rate& rate : kRates) texts.emplace_back(rate.text);
    return texts;
  }();
  return all;
}

std::vector<fs::path> stableNames(const fs::path& root) {
  std::vector<fs::path> names;
  std::error_code error;
  for (fs::directory_iterator it(root / "dev/serial/by-id", error), end; !error && it != end;
       it.increment(error))
    names.push_back(it->path());
  std::ranges::sort(names);
  return names;
}

}  // namespace patina::devices::serial
