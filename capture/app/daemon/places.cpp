// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/places.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <vector>

#include "capture/failure.h"
#include "processing/image/sha256.h"

namespace patina::daemon {
namespace {

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

// systemd gives several folders with colons between them; ours is the first.
std::vector<std::filesystem::path> candidates() {
  std::vector<std::filesystem::path> folders;
  const std::string systemd = environment("RUNTIME_DIRECTORY");
  if (!systemd.empty()) folders.emplace_back(systemd.substr(0, systemd.find(':')));
  const std::string user = environment("XDG_RUNTIME_DIR");
  if (::geteuid() == 0) folders.emplace_back("/run/patina");
  if (!user.empty()) folders.push_back(std::filesystem::path(user) / "patina");
  return folders;
}

Places in(const std::filesystem::path& folder, const std::string& name) {
  return {folder / (name + ".sock"), folder / (name + ".token")};
}

}  // namespace

std::string nameOfArchive(const std::filesystem::path& archive) {
  std::error_code error;
  auto canonical = std::filesystem::weakly_canonical(archive, error);
  if (error) canonical = std::filesystem::absolute(archive).lexically_normal();
  if (!canonical.has_filename()) canonical = canonical.parent_path();  // "archive/"
  return sha256(canonical.string()).hex().substr(0, 16);
}

Places placesToListen(const std::filesystem::path& archive) {
  const auto folders = candidates();
  if (folders.empty())
    throw capture::CaptureError(Exit::kConfig,
                                "there is no place for the socket: set XDG_RUNTIME_DIR, or let "
                                "systemd start the daemon");
  std::error_code error;
  const bool made = std::filesystem::create_directories(folders.front(), error);
  if (error)
    throw capture::CaptureError(Exit::kCannotCreate,
                                "cannot make " + folders.front().string() + ": " + error.message());
  if (made) ::chmod(folders.front().c_str(), ::geteuid() == 0 ? 0755 : 0700);
  return in(folders.front(), nameOfArchive(archive));
}

Places placesToCall(const std::filesystem::path& archive) {
  auto folders = candidates();
  folders.emplace_back("/run/patina");  // a daemon of the system, asked by a user
  const std::string name = nameOfArchive(archive);
  for (const auto& folder : folders) {
    Places places = in(folder, name);
    std::error_code error;
    if (std::filesystem::exists(places.socket, error)) return places;
  }
  throw capture::CaptureError(Exit::kUnavailable, "no daemon is at work on " + archive.string() +
                                                      ": start `patina daemon --archive " +
                                                      archive.string() + "`");
}

}  // namespace patina::daemon
