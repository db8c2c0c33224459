// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/connections.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>

namespace patina::http {
namespace {

bool hasHungUp(int fd) {
  pollfd state{fd, POLLRDHUP, 0};
  return poll(&state, 1, 0) == 1 && (state.revents & (POLLRDHUP | POLLHUP | POLLERR)) != 0;
}

}  // namespace

Connection* Connections::add(Connection connection) {
  const std::lock_guard lock(mutex_);
  return &connections_.emplace_back(std::move(connection));
}

void Connections::remove(Connection* connection) {
  const std::lock_guard lock(mutex_);
  connections_.remove_if([connection](const Connection& one) { return &one == connection; });
}

void Connections::setDeadline(Connection* connection, MonoTime deadline) {
  const std::lock_guard lock(mutex_);
  connection->deadline = deadline;
}

void Connections::markStream(Connection* connection) {
  const std::lock_guard lock(mutex_);
  connection->stream = true;
  connection->deadline = MonoTime::max();
}

Connections::Shut Connections::shutLate(MonoTime now) {
  const std::lock_guard lock(mutex_);
  Shut shut{0, 0};
  for (Connection& one : connections_) {
    const bool is_late = now >= one.deadline, is_gone = one.stream && hasHungUp(one.fd);
    if (!is_late && !is_gone) continue;
    shut.late += is_late;
    shut.streams += is_gone;
    one.deadline = MonoTime::max();
    shutdown(one.fd, SHUT_RDWR);
  }
  return shut;
}

std::size_t Connections::count() const {
  const std::lock_guard lock(mutex_);
  return connections_.size();
}

std::size_t Connections::countOfPeer(const std::string& peer) const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(
      std::count_if(connections_.begin(), connections_.end(),
                    [&peer](const Connection& one) { return one.peer == peer; }));
}

}  // namespace patina::http
