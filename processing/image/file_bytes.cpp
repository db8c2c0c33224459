// SPDX-License-Identifier: GPL-3.0-or-later
// Whole files in and out, for picture_file.h and atomic_file.h.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

#include "processing/image/atomic_file.h"
#include "processing/image/picture_file.h"

namespace patina {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  bool close() {
    const int fd = fd_;
    fd_ = -1;
    return ::close(fd) == 0;
  }

 private:
  int fd_;
};

[[noreturn]] void fail(Exit fallback, const std::filesystem::path& path, const char* what) {
  const int error = errno;
  const Exit exit = error == EACCES || error == EPERM || error == EROFS ? Exit::kPermission
                    : error == ENOSPC || error == EDQUOT                ? Exit::kCannotCreate
                                                                        : fallback;
  throw ProcessingError(exit, path.string() + ": " + what + ": " + std::strerror(error));
}

bool writeAll(int fd, std::span<const std::byte> data) {
  while (!data.empty()) {
    const ssize_t n = ::write(fd, data.data(), std::min<std::size_t>(data.size(), 1 << 30));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    data = data.subspan(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace

Bytes readFile(const std::filesystem::path& path, std::uint64_t bytes_max) {
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (fd.get() < 0) fail(Exit::kBadData, path, "cannot be opened");
  struct stat status {};
  if (::fstat(fd.get(), &status) != 0) fail(Exit::kIo, path, "cannot be read");
  if (S_ISDIR(status.st_mode))
    throw ProcessingError(Exit::kBadData, path.string() + ": is a folder, not a file");
  const auto too_large = [&] {
    throw ProcessingError(Exit::kBadData, path.string() + ": is larger than the " +
                                              formatBytes(bytes_max) +
                                              " that are read of such a file");
  };
  if (S_ISREG(status.st_mode) && static_cast<std::uint64_t>(status.st_size) > bytes_max)
    too_large();
  // One byte more than expected, so that the end is seen without another growth.
  Bytes out(static_cast<std::size_t>(std::max<off_t>(status.st_size, 0)) + 1);
  std::size_t filled = 0;
  for (;;) {
    if (filled == out.size()) out.resize(out.size() * 2);
    const ssize_t n = ::read(fd.get(), out.data() + filled, out.size() - filled);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(Exit::kIo, path, "cannot be read");
    if (n == 0) break;
    filled += static_cast<std::size_t>(n);
    if (filled > bytes_max) too_large();
  }
  out.resize(filled);
  return out;
}

std::filesystem::path temporaryBeside(const std::filesystem::path& path) {
  static std::atomic<unsigned> counter{0};
  std::filesystem::path temporary = path;
  temporary += ".tmp" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
  return temporary;
}

void publishAtomically(const std::filesystem::path& temporary, const std::filesystem::path& path) {
  bool good = false;
  {
    Descriptor fd(::open(temporary.c_str(), O_RDONLY | O_CLOEXEC));
    good = fd.get() >= 0 && ::fsync(fd.get()) == 0 && fd.close() &&
           ::rename(temporary.c_str(), path.c_str()) == 0;
  }
  if (!good) {
    const int error = errno;
    ::unlink(temporary.c_str());
    errno = error;
    fail(Exit::kIo, path, "cannot be written");
  }
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() < 0 || ::fsync(fd.get()) != 0)
    fail(Exit::kIo, folder, "the folder cannot be synchronised");
}

void writeFileAtomically(const std::filesystem::path& path, std::span<const std::byte> data) {
  const std::filesystem::path temporary = temporaryBeside(path);
  Descriptor fd(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (fd.get() < 0) fail(Exit::kCannotCreate, path, "cannot be created");
  if (!writeAll(fd.get(), data) || !fd.close()) {
    const int error = errno;
    ::unlink(temporary.c_str());
    errno = error;
    fail(Exit::kIo, path, "cannot be written");
  }
  publishAtomically(temporary, path);
}

void writeFileAtomically(const std::filesystem::path& path, const std::string& text) {
  writeFileAtomically(path, std::as_bytes(std::span(text.data(), text.size())));
}

void writeFolderAtomically(const std::filesystem::path& folder,
                           const std::function<void(const std::filesystem::path&)>& fill) {
  const std::filesystem::path temporary = temporaryBeside(folder);
  try {
    std::filesystem::create_directories(temporary);
    fill(temporary);
    std::filesystem::remove_all(folder);
    std::filesystem::rename(temporary, folder);
  } catch (const std::filesystem::filesystem_error& e) {
    std::error_code none;
    std::filesystem::remove_all(temporary, none);
    throw ProcessingError(Exit::kCannotCreate,
                          folder.string() + " cannot be written: " + e.code().message());
  } catch (...) {
    std::error_code none;
    std::filesystem::remove_all(temporary, none);
    throw;
  }
}

}  // namespace patina
