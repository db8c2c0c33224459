// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/capture/app/http/wire.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cctype>
#include <cstring>
#include <system_error>

namespace patina::http {
namespace {

void must(int result) {
  if (result != 0) throw std::system_error(errno, std::generic_category(), "test socket");
}

}  // namespace

Wire Wire::tcp(int port, const std::string& from) {
  devices::Descriptor fd(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  inet_pton(AF_INET, from.c_str(), &address.sin_addr);
  must(bind(fd.fd(), reinterpret_cast<sockaddr*>(&address), sizeof address));
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, "127.0.0.1", &address.sin_addr);
  must(connect(fd.fd(), reinterpret_cast<sockaddr*>(&address), sizeof address));
  return Wire(std::move(fd));
}

Wire Wire::local(const std::filesystem::path& socket_path) {
  devices::Descriptor fd(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, socket_path.c_str(), sizeof address.sun_path - 1);
  must(connect(fd.fd(), reinterpret_cast<sockaddr*>(&address), sizeof address));
  return Wire(std::move(fd));
}

bool Wire::send(const std::string& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::send(socket_.fd(), bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

bool Wire::fill() {
  char bytes[16384];
  const ssize_t n = recv(socket_.fd(), bytes, sizeof bytes, 0);
  if (n <= 0) return false;
  buffer_.append(bytes, static_cast<std::size_t>(n));
  return true;
}

std::string Wire::line() {
  std::size_t end = buffer_.find('\n');
  while (end == std::string::npos && fill()) end = buffer_.find('\n');
  std::string found = buffer_.substr(0, end);
  buffer_.erase(0, end == std::string::npos ? end : end + 1);
  if (!found.empty() && found.back() == '\r') found.pop_back();
  return found;
}

WireReply Wire::reply(const std::string& method) {
  WireReply reply;
  const std::string first = line();
  if (first.size() < 12) return reply;
  reply.status = std::stoi(first.substr(9, 3));
  for (std::string field = line(); !field.empty(); field = line()) {
    std::string name = field.substr(0, field.find(':'));
    for (char& c : name) c = static_cast<char>(std::tolower(c));
    reply.fields[name] = field.substr(field.find(':') + 2);
  }
  const auto length = reply.fields.find("content-length");
  if (method == "HEAD" || length == reply.fields.end()) return reply;
  const std::size_t bytes = std::stoul(length->second);
  while (buffer_.size() < bytes && fill()) continue;
  reply.body = buffer_.substr(0, bytes);
  buffer_.erase(0, bytes);
  return reply;
}

bool Wire::ended() {
  while (fill()) continue;
  buffer_.clear();
  return true;
}

WireReply Wire::ask(const std::string& request, const std::string& method) {
  send(request);
  return reply(method);
}

}  // namespace patina::http
