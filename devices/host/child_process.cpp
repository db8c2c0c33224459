// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "devices/driver_notes.h"

extern char** environ;

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;

constexpr int kChannelFd = 3;
constexpr Nanoseconds kGrace = 500ms;      // to close its devices
constexpr Nanoseconds kKilledWithin = 2s;  // a process in the kernel's hands is left behind

auto failed(const char* what, int error) {
  return fail(Errc::kLost, std::string("its driver's process cannot be started: ") + what + ": " +
                               std::strerror(error));
}

// What posix_spawn is told, freed in any case.
struct SpawnSettings {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;

  explicit SpawnSettings(int channel) {
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files, channel, kChannelFd);
    posix_spawn_file_actions_addclosefrom_np(&files, kChannelFd + 1);
    posix_spawnattr_init(&attributes);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes,
                             POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSID);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
};

// The environment with another HOME, and notes in it.
std::vector<std::string> environmentWith(const std::filesystem::path& home) {
  const std::string notes = std::string(kDriverNotes) + "=";
  std::vector<std::string> all{"HOME=" + home.string(), notes + home.string()};
  for (char** entry = environ; *entry; ++entry)
    if (std::strncmp(*entry, "HOME=", 5) != 0 &&
        std::strncmp(*entry, notes.c_str(), notes.size()) != 0)
      all.emplace_back(*entry);
  return all;
}

std::vector<char*> pointersTo(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

}  // namespace

Result<std::shared_ptr<const DriverHome>> DriverHome::make() {
  std::error_code error;
  const auto temporary = std::filesystem::temp_directory_path(error);
  std::string folder = ((error ? "/tmp" : temporary) / "patina-driver-XXXXXX").string();
  if (!mkdtemp(folder.data())) return failed(folder.c_str(), errno);
  return std::shared_ptr<const DriverHome>(new DriverHome(folder));
}

DriverHome::~DriverHome() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

ChildProcess::ChildProcess(pid_t pid, std::shared_ptr<const DriverHome> home)
    : pid_(pid),
      handle_(static_cast<int>(syscall(SYS_pidfd_open, pid, 0))),
      home_(std::move(home)) {}

Result<std::unique_ptr<ChildProcess>> ChildProcess::start(std::vector<std::string> command,
                                                          const Descriptor& channel,
                                                          std::shared_ptr<const DriverHome> home) {
  if (!home) {
    auto made = DriverHome::make();
    if (!made) return tl::make_unexpected(made.error());
    home = std::move(*made);
  }
  // dup2 of 3 onto itself would leave it to be closed on exec.
  const Descriptor elsewhere(fcntl(channel.fd(), F_DUPFD_CLOEXEC, kChannelFd + 1));
  const SpawnSettings settings(elsewhere.fd());
  command.insert(command.end(), {"--fd", std::to_string(kChannelFd)});
  std::vector<std::string> environment = environmentWith(home->path());
  pid_t pid = 0;
  const int refused =
      posix_spawn(&pid, command.front().c_str(), &settings.files, &settings.attributes,
                  pointersTo(command).data(), pointersTo(environment).data());
  if (refused != 0) return failed(command.front().c_str(), refused);
  return std::unique_ptr<ChildProcess>(new ChildProcess(pid, std::move(home)));
}

ChildProcess::~ChildProcess() {
  if (!ended(kGrace)) kill();
}

bool ChildProcess::ended(Nanoseconds within) {
  if (reaped_) return true;
  pollfd child{handle_.fd(), POLLIN, 0};
  const auto wait_ms = std::chrono::ceil<std::chrono::milliseconds>(within).count();
  while (handle_.fd() >= 0 && poll(&child, 1, static_cast<int>(wait_ms)) < 0 && errno == EINTR) {
  }
  reaped_ = waitpid(pid_, nullptr, WNOHANG) == pid_;
  return reaped_;
}

void ChildProcess::kill() {
  if (reaped_) return;
  ::kill(-pid_, SIGKILL);  // and what it started: the session is its own
  ::kill(pid_, SIGKILL);
  ended(kKilledWithin);
}

}  // namespace patina::devices::host
