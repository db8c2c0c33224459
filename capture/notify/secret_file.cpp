// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/secret_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "capture/notify/notifier.h"

namespace patina::capture::notify {
namespace {

constexpr std::size_t kBytesMost = 4096;

class OpenFile {
 public:
  // Without blocking, should it be a pipe.
  explicit OpenFile(const std::filesystem::path& file)
      : fd_(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~OpenFile() {
    if (fd_ >= 0) close(fd_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

}  // namespace

std::string readSecret(const std::filesystem::path& file) {
  const auto refuse = [&](Exit exit, const std::string& problem) -> NotifyError {
    return {exit, "the secret " + file.string() + " " + problem};
  };
  const OpenFile opened(file);
  struct stat is {};
  if (opened.fd() < 0 || fstat(opened.fd(), &is) != 0)
    throw refuse(errno == EACCES ? Exit::kPermission : Exit::kConfig,
                 std::string("cannot be read: ") + std::strerror(errno));
  if (!S_ISREG(is.st_mode)) throw refuse(Exit::kConfig, "is no regular file");
  if ((is.st_mode & S_IRWXO) != 0)
    throw refuse(Exit::kPermission, "is open to everybody: chmod o= " + file.string());
  std::string text(kBytesMost + 1, '\0');
  const ssize_t got = read(opened.fd(), text.data(), text.size());
  if (got < 0) throw refuse(Exit::kConfig, "cannot be read");
  text.resize(static_cast<std::size_t>(got));
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  if (text.empty() || text.size() > kBytesMost ||
      std::any_of(text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }))
    throw refuse(Exit::kConfig, "must hold one line of printable characters, at most 4 KiB");
  return text;
}

}  // namespace patina::capture::notify
