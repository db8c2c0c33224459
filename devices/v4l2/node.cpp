// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/node.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace patina::devices::v4l2 {
namespace {

Errc codeOf(int error) {
  switch (error) {
    case ENODEV:
    case ENXIO:
    case ENOENT:
    case EIO:  // the driver's stream broke: only opening it again helps
    case EPIPE:
    case EBADF:
    case ESHUTDOWN:
      return Errc::kLost;
    case EBUSY:
      return Errc::kBusy;
    case ETIMEDOUT:
    case EPROTO:
      return Errc::kTimeout;
    default:
      return Errc::kRefused;
  }
}

const char* adviceOn(int error) {
  switch (error) {
    case EACCES:
    case EPERM:
      return "; may this user? join the group 'video' or install the udev rules";
    case EBUSY:
      return "; another program uses the camera: end it";
    case ENODEV:
    case ENXIO:
    case ENOENT:
      return "; it was unplugged";
    default:
      return "";
  }
}

}  // namespace

Node::Node(int fd, std::string path, std::string who)
    : fd_(fd), path_(std::move(path)), who_(std::move(who)) {}

Node::Node(Node&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      path_(std::move(other.path_)),
      who_(std::move(other.who_)) {}

Node& Node::operator=(Node&& other) noexcept {
  std::swap(fd_, other.fd_);
  std::swap(path_, other.path_);
  std::swap(who_, other.who_);
  return *this;
}

Node::~Node() {
  if (fd_ >= 0) close(fd_);
}

Result<Node> Node::open(const std::string& path, const std::string& who) {
  Node node(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC), path, who);
  if (node.fd_ < 0) return node.failed("open", errno);
  return node;
}

int Node::ask(unsigned long request, void* argument) const {
  while (ioctl(fd_, request, argument) != 0)
    if (errno != EINTR) return errno;
  return 0;
}

Result<void> Node::call(unsigned long request, void* argument, const std::string& what) const {
  if (const int error = ask(request, argument)) return failed(what, error);
  return {};
}

tl::unexpected<Error> Node::failed(const std::string& what, int error) const {
  return fail(codeOf(error),
              who_ + ": " + path_ + ": " + what + ": " + std::strerror(error) + adviceOn(error));
}

}  // namespace patina::devices::v4l2
