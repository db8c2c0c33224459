// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/private_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "capture/app/http/messages.h"
#include "devices/descriptor.h"

namespace patina::http {
namespace {

[[noreturn]] void failWrite(const std::filesystem::path& file) {
  throw HttpError(Exit::kCannotCreate,
                  file.string() + ": cannot be written: " + std::strerror(errno));
}

// Nobody of `closed_to` (bits of a mode) may be let in by the file's own.
std::optional<std::string> readFile(const std::filesystem::path& file, int flags, mode_t closed_to,
                                    std::size_t bytes_max) {
  const devices::Descriptor in(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | flags));
  if (in.fd() < 0 && errno == ENOENT) return std::nullopt;
  if (in.fd() < 0)
    throw HttpError(Exit::kPermission, file.string() + ": cannot be read: " + std::strerror(errno));
  struct stat facts {};
  if (fstat(in.fd(), &facts) != 0 || !S_ISREG(facts.st_mode))
    throw HttpError(Exit::kConfig, file.string() + ": is no regular file");
  if ((facts.st_mode & closed_to) != 0)
    throw HttpError(Exit::kConfig,
                    file.string() + ": others may read it: replace it, and then chmod 600");
  std::string text(bytes_max + 1, '\0');
  std::size_t got = 0;
  while (got < text.size()) {
    const ssize_t n = read(in.fd(), text.data() + got, text.size() - got);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0)
      throw HttpError(Exit::kIo, file.string() + ": cannot be read: " + std::strerror(errno));
    if (n == 0) break;
    got += static_cast<std::size_t>(n);
  }
  if (got > bytes_max) throw HttpError(Exit::kConfig, file.string() + ": is too large");
  text.resize(got);
  return text;
}

std::string readPem(const std::filesystem::path& file, mode_t closed_to) {
  constexpr std::size_t kPemBytesMax = 256 << 10;
  auto text = readFile(file, 0, closed_to, kPemBytesMax);
  if (!text) throw HttpError(Exit::kConfig, file.string() + ": is not there");
  return *text;
}

}  // namespace

void writePrivateFile(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path unfinished = file.string() + ".new";
  unlink(unfinished.c_str());  // of a start that died
  {
    const devices::Descriptor out(
        open(unfinished.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600));
    if (out.fd() < 0) failWrite(file);
    std::size_t done = 0;
    while (done < text.size()) {
      const ssize_t n = write(out.fd(), text.data() + done, text.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) failWrite(file);
      done += static_cast<std::size_t>(n);
    }
    if (fsync(out.fd()) != 0) failWrite(file);
  }
  if (std::rename(unfinished.c_str(), file.c_str()) != 0) failWrite(file);
}

std::optional<std::string> readPrivateFile(const std::filesystem::path& file,
                                           std::size_t bytes_max) {
  return readFile(file, O_NOFOLLOW, 077, bytes_max);
}

std::string readCertificate(const std::filesystem::path& file) { return readPem(file, 0); }

std::string readKey(const std::filesystem::path& file) { return readPem(file, 007); }

}  // namespace patina::http
