// SPDX-License-Identifier: GPL-3.0-or-later
// The sockets the server listens on, and who is at the other end.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>

#include "capture/app/http/messages.h"
#include "devices/descriptor.h"

namespace patina::http {

// Mode 0660, of `group` when one is given. A socket that nobody listens on any more is taken over;
// one that somebody does is HttpError(kTemporary). The folder must be there.
devices::Descriptor listenOnUnix(const std::filesystem::path& path, std::optional<gid_t> group);
// `address` in numbers, IPv4 or IPv6. Port 0 takes any free one.
devices::Descriptor listenOnTcp(const std::string& address, int port);
int portOf(const devices::Descriptor& socket);

bool isLoopback(const std::string& address);  // in numbers: 127.x.y.z or ::1
// Outside the loopback a listener needs a token that somebody holds, and a line nobody reads:
// otherwise HttpError(kConfig), which says what to do.
void checkExposure(const std::string& address, bool has_token, bool has_tls, bool behind_proxy);

// Who connected: root and our own user are kAdmin, anybody else `others`.
Role roleOfPeer(int unix_connection, Role others);
// Address in numbers, without port; "unix" for a unix socket.
std::string peerName(int connection);

}  // namespace patina::http
