// SPDX-License-Identifier: GPL-3.0-or-later
// Where the daemon of an archive is reached: a socket whose name follows from the archive, so that
// the command line needs no other word than --archive.
#pragma once

#include <filesystem>
#include <string>

namespace patina::daemon {

struct Places {
  std::filesystem::path socket, token;  // NAME.sock, NAME.token: 16 hex digits of the archive
};

// The first 16 hex digits of the SHA-256 of the archive's canonical path.
std::string nameOfArchive(const std::filesystem::path& archive);

// For the daemon: $RUNTIME_DIRECTORY (systemd), /run/patina for root, $XDG_RUNTIME_DIR/patina
// else; the folder is made (0755 for root, 0700 else). Failure(kConfig) when there is none of them.
Places placesToListen(const std::filesystem::path& archive);
// For who talks to it: the first of these folders that holds the socket. Failure(kUnavailable),
// with the command to start it, when none does.
Places placesToCall(const std::filesystem::path& archive);

}  // namespace patina::daemon
