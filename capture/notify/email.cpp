// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/email.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "capture/notify/wait.h"

namespace patina::capture::notify {
namespace {

constexpr std::size_t kBodyLineMost = 900;  // RFC 5322 allows 998
constexpr std::size_t kComplaintMost = 200;

// Memory that is read like a file: it never blocks whoever writes it.
class Scratch {
 public:
  explicit Scratch(const char* name) : fd_(memfd_create(name, MFD_CLOEXEC)) {}
  ~Scratch() {
    if (fd_ >= 0) close(fd_);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  int fd() const { return fd_; }

  bool fill(const std::string& text) const {
    return write(fd_, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
           lseek(fd_, 0, SEEK_SET) == 0;
  }
  std::string firstLine() const {
    std::string text(kComplaintMost, '\0');
    const ssize_t got = pread(fd_, text.data(), text.size(), 0);
    text.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return oneLine(text.substr(0, text.find('\n')));
  }

 private:
  int fd_;
};

// RFC 5322 in UTC, whatever the locale: "Wed, 01 May 2024 12:00:00 +0000".
std::string dateOf(UtcTime utc) {
  static constexpr const char* kDays[] = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  static constexpr const char* kMonths[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                            "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const auto day = std::chrono::floor<std::chrono::days>(utc);
  const std::chrono::year_month_day date(day);
  const unsigned month = static_cast<unsigned>(date.month());
  const std::string iso = formatUtc(utc);  // 2024-05-01T12:00:00.000Z
  return std::string(kDays[std::chrono::weekday(day).c_encoding()]) + ", " + iso.substr(8, 2) +
         " " + kMonths[month - 1] + " " + iso.substr(0, 4) + " " + iso.substr(11, 8) + " +0000";
}

std::string bodyOf(const Message& message) {
  std::string body;
  std::size_t in_line = 0;
  for (const char c : textOf(message)) {
    const bool begins_letter = (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    if (c != '\n' && in_line >= kBodyLineMost && begins_letter) {
      body += '\n';
      in_line = 0;
    }
    body += c;
    in_line = c == '\n' ? 0 : in_line + 1;
  }
  return body;
}

struct Spawned {
  pid_t pid = -1;
  int error = 0;
};

// The signals that this program ignores or blocks are none of its child's.
Spawned spawn(const std::filesystem::path& program, const Scratch& in, const Scratch& err) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, in.fd(), STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&files, err.fd(), STDERR_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  posix_spawnattr_t how;
  posix_spawnattr_init(&how);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&how, &none);
  posix_spawnattr_setsigdefault(&how, &all);
  posix_spawnattr_setpgroup(&how, 0);
  posix_spawnattr_setflags(&how,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  std::string path = program.string(), dots = "-i", headers = "-t";
  char* const arguments[] = {path.data(), dots.data(), headers.data(), nullptr};
  std::string search = "PATH=/usr/sbin:/usr/bin:/sbin:/bin", locale = "LC_ALL=C";
  char* const environment[] = {search.data(), locale.data(), nullptr};
  Spawned child;
  child.error = posix_spawn(&child.pid, path.c_str(), &files, &how, arguments, environment);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&how);
  return child;
}

// Ends with the child gone and reaped, however it went. -1: it was killed.
int exitOf(pid_t pid, Nanoseconds limit, const std::stop_token& hurry) {
  // Not by its function: glibc 2.36 forgot to declare it as one of C.
  const int pidfd = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  bool ended = false;
  if (pidfd >= 0) {
    try {
      ended = Wait(limit).untilReadable(pidfd, hurry) == Waited::kReady;
    } catch (const NotifyError&) {
      ended = false;
    }
    close(pidfd);
  }
  if (!ended) kill(-pid, SIGKILL);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// sysexits.h: 64 to 68 and 76 to 78 say that this message will never go.
bool isHopeless(int exit) { return (exit >= 64 && exit <= 68) || exit == 76 || exit == 78; }

}  // namespace

std::string mailOf(const Message& message, const EmailSettings& settings) {
  std::string to;
  for (const std::string& address : settings.to) to += (to.empty() ? "" : ",\n ") + address;
  std::string mail = "To: " + to + "\n";
  if (!settings.from.empty()) mail += "From: Patina <" + settings.from + ">\n";
  mail += "Subject: " + subjectOf(message) + "\n";
  mail += "Date: " + dateOf(message.utc) + "\n";
  mail +=
      "MIME-Version: 1.0\n"
      "Content-Type: text/plain; charset=utf-8\n"
      "Content-Transfer-Encoding: 8bit\n"
      "Auto-Submitted: auto-generated\n";
  if (message.severity == Severity::kCritical) mail += "Importance: high\n";
  return mail + "\n" + bodyOf(message);
}

Email::Email(EmailSettings settings, std::filesystem::path sendmail, Nanoseconds limit)
    : settings_(std::move(settings)),
      sendmail_(std::move(sendmail)),
      limit_(limit),
      name_("email " + settings_.to.front()) {}

bool Email::wants(const Message& message) const { return isForPeople(message, settings_.least); }

Delivery Email::send(const Message& message, const std::stop_token& hurry) {
  const Scratch mail("mail"), complaint("complaint");
  if (mail.fd() < 0 || complaint.fd() < 0 || !mail.fill(mailOf(message, settings_)))
    return {Delivery::Result::kTryAgain, "no memory or descriptor for the mail"};
  const Spawned child = spawn(sendmail_, mail, complaint);
  if (child.error != 0)
    return {Delivery::Result::kTryAgain, sendmail_.string() + ": " + std::strerror(child.error) +
                                             "; install a mail transport, as postfix or msmtp-mta"};
  const int exit = exitOf(child.pid, limit_, hurry);
  if (exit == 0) return {Delivery::Result::kDelivered, "taken by sendmail"};
  if (exit < 0)
    return {Delivery::Result::kTryAgain,
            "sendmail did not end within " + formatDuration(limit_) + " and was killed"};
  const std::string said = complaint.firstLine();
  return {isHopeless(exit) ? Delivery::Result::kRefused : Delivery::Result::kTryAgain,
          "sendmail ended with " + std::to_string(exit) + (said.empty() ? "" : ": " + said)};
}

}  // namespace patina::capture::notify
