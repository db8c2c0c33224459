// SPDX-License-Identifier: GPL-3.0-or-later
// The open connections and their deadlines. A deadline is for a whole phase, not for the next byte:
// a client that trickles is as late as one that is silent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>
#include <string>

#include "capture/app/http/messages.h"
#include "processing/image/units.h"

namespace patina::http {

struct Connection {
  int fd = -1;
  std::string peer;  // address without port; "unix"
  bool local = false, stream = false;
  Role local_role = Role::kPublic;
  MonoTime deadline = MonoTime::max();
};

// Thread-safe. A connection is removed before its descriptor is closed, so that shutting one down
// never hits a descriptor that was given out again.
class Connections {
 public:
  Connection* add(Connection connection);
  void remove(Connection* connection);
  void setDeadline(Connection* connection, MonoTime deadline);
  void markStream(Connection* connection);  // no deadline; ends when the peer is gone
  // Shuts down whatever is late and the streams whose peer has hung up.
  struct Shut {
    std::size_t late, streams;
  };
  Shut shutLate(MonoTime now);
  std::size_t count() const;
  std::size_t countOfPeer(const std::string& peer) const;

 private:
  mutable std::mutex mutex_;
  std::list<Connection> connections_;
};

}  // namespace patina::http
