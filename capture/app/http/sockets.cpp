// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/sockets.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

namespace patina::http {
namespace {

constexpr int kBacklog = 64;

[[noreturn]] void fail(Exit exit, const std::string& what, int error) {
  throw HttpError(exit, what + ": " + std::strerror(error));
}

sockaddr_un unixAddress(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.size() >= sizeof address.sun_path)
    throw HttpError(Exit::kConfig, name +
                                       ": a socket's path has at most 107 bytes: name a shorter "
                                       "folder by XDG_RUNTIME_DIR");
  std::memcpy(address.sun_path, name.c_str(), name.size() + 1);
  return address;
}

template <class Address>
const sockaddr* generic(const Address& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

void removeStaleSocket(const std::filesystem::path& path, const sockaddr_un& address) {
  struct stat facts {};
  if (lstat(path.c_str(), &facts) != 0) return;
  if (!S_ISSOCK(facts.st_mode))
    throw HttpError(Exit::kCannotCreate,
                    path.string() + ": is in the way and no socket: remove it");
  const devices::Descriptor probe(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const bool answers = connect(probe.fd(), generic(address), sizeof address) == 0;
  if (answers || errno == EAGAIN)
    throw HttpError(Exit::kTemporary,
                    path.string() + ": another daemon listens here: stop it first");
  unlink(path.c_str());
}

struct Resolved {
  sockaddr_storage address{};
  socklen_t bytes = 0;
};

Resolved resolve(const std::string& address, int port) {
  addrinfo hints{}, *list = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  if (port < 0 || port > 65535 ||
      getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &list) != 0)
    throw HttpError(Exit::kConfig, "listen = \"" + address + "\", port " + std::to_string(port) +
                                       ": not an address in numbers and a port up to 65535");
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(list, &freeaddrinfo);
  Resolved resolved;
  resolved.bytes = list->ai_addrlen;
  std::memcpy(&resolved.address, list->ai_addr, list->ai_addrlen);
  return resolved;
}

sockaddr_storage addressOf(int fd, decltype(&getpeername) ask) {
  sockaddr_storage address{};
  socklen_t bytes = sizeof address;
  ask(fd, reinterpret_cast<sockaddr*>(&address), &bytes);
  return address;
}

}  // namespace

devices::Descriptor listenOnUnix(const std::filesystem::path& path, std::optional<gid_t> group) {
  constexpr mode_t kMode = 0660;
  const sockaddr_un address = unixAddress(path);
  removeStaleSocket(path, address);
  devices::Descriptor listener(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (listener.fd() < 0) fail(Exit::kTemporary, "no socket", errno);
  // Before it has a name, so that it is never open to more than it should be; then again, for what
  // the umask took away.
  fchmod(listener.fd(), kMode);
  if (bind(listener.fd(), generic(address), sizeof address) != 0)
    fail(Exit::kCannotCreate, path.string() + ": cannot make the socket", errno);
  if (group && chown(path.c_str(), static_cast<uid_t>(-1), *group) != 0)
    fail(Exit::kPermission, path.string() + ": cannot give the socket to its group", errno);
  if (chmod(path.c_str(), kMode) != 0 || listen(listener.fd(), kBacklog) != 0)
    fail(Exit::kCannotCreate, path.string() + ": cannot listen", errno);
  return listener;
}

devices::Descriptor listenOnTcp(const std::string& address, int port) {
  const Resolved resolved = resolve(address, port);
  devices::Descriptor listener(
      socket(resolved.address.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (listener.fd() < 0) fail(Exit::kTemporary, "no socket", errno);
  const int on = 1;
  setsockopt(listener.fd(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (bind(listener.fd(), generic(resolved.address), resolved.bytes) != 0 ||
      listen(listener.fd(), kBacklog) != 0)
    fail(Exit::kUnavailable,
         "cannot listen on " + address + " port " + std::to_string(port) +
             " (name another port, or stop what has it)",
         errno);
  return listener;
}

int portOf(const devices::Descriptor& socket) {
  const sockaddr_storage address = addressOf(socket.fd(), &getsockname);
  // The port lies at the same place in both families.
  return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

bool isLoopback(const std::string& address) {
  in_addr four{};
  in6_addr six{};
  if (inet_pton(AF_INET, address.c_str(), &four) == 1) return (ntohl(four.s_addr) >> 24) == 127;
  return inet_pton(AF_INET6, address.c_str(), &six) == 1 && IN6_IS_ADDR_LOOPBACK(&six);
}

void checkExposure(const std::string& address, bool has_token, bool has_tls, bool behind_proxy) {
  if (isLoopback(address)) return;
  const std::string where = "listen = \"" + address + "\" is open to other machines: ";
  if (!has_token)
    throw HttpError(Exit::kConfig,
                    where + "make a named token first, while it listens on 127.0.0.1");
  if (!has_tls && !behind_proxy)
    throw HttpError(Exit::kConfig,
                    where + "name a TLS certificate and key, or set behind_proxy = true");
}

Role roleOfPeer(int unix_connection, Role others) {
  ucred peer{};
  socklen_t bytes = sizeof peer;
  if (getsockopt(unix_connection, SOL_SOCKET, SO_PEERCRED, &peer, &bytes) != 0)
    return Role::kPublic;
  return peer.uid == 0 || peer.uid == geteuid() ? Role::kAdmin : others;
}

std::string peerName(int connection) {
  const sockaddr_storage address = addressOf(connection, &getpeername);
  char text[INET6_ADDRSTRLEN] = "unknown";
  if (address.ss_family == AF_UNIX) return "unix";
  if (address.ss_family == AF_INET)
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in&>(address).sin_addr, text, sizeof text);
  if (address.ss_family == AF_INET6)
    inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6&>(address).sin6_addr, text,
              sizeof text);
  return text;
}

}  // namespace patina::http
