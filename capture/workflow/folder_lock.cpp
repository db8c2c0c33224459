// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/folder_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "capture/workflow/failure.h"

namespace patina::workflow {

namespace fs = std::filesystem;

FolderLock::FolderLock(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  fd_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd_ < 0)
    throw WorkflowError(Exit::kCannotCreate,
                        folder.string() + " cannot be made: " + std::strerror(errno));
  while (::flock(fd_, LOCK_EX) != 0)
    if (errno != EINTR) {
      const int why = errno;
      ::close(fd_);
      throw WorkflowError(Exit::kCannotCreate,
                          folder.string() + " cannot be locked: " + std::strerror(why));
    }
  // Names of temporaryBeside(): nobody else writes here while we hold the lock.
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (entry.path().filename().string().find(".tmp") != std::string::npos)
      fs::remove_all(entry.path(), error);
}

FolderLock::~FolderLock() { ::close(fd_); }

}  // namespace patina::workflow
