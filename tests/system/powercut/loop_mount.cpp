// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/powercut/loop_mount.h"

#include <fcntl.h>
#include <linux/loop.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "tests/support/places.h"

namespace patina::testing {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void failSystem(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

// The loop device's descriptor; another process may snatch a free device, hence the tries.
int attach(const fs::path& image, std::string* device) {
  const int file = ::open(image.c_str(), O_RDWR | O_CLOEXEC);
  if (file < 0) failSystem("opening " + image.string());
  const int control = ::open("/dev/loop-control", O_RDWR | O_CLOEXEC);
  if (control < 0) failSystem("opening /dev/loop-control");
  int loop = -1;
  for (int attempt = 0; attempt < 100 && loop < 0; ++attempt) {
    const int number = ::ioctl(control, LOOP_CTL_GET_FREE);
    if (number < 0) failSystem("asking for a loop device");
    *device = "/dev/loop" + std::to_string(number);
    loop = ::open(device->c_str(), O_RDWR | O_CLOEXEC);
    if (loop < 0) failSystem("opening " + *device);
    loop_config config{};
    config.fd = static_cast<std::uint32_t>(file);
    config.info.lo_flags = LO_FLAGS_AUTOCLEAR;
    if (::ioctl(loop, LOOP_CONFIGURE, &config) == 0) break;
    ::close(loop);
    loop = -1;
    if (errno != EBUSY) failSystem("attaching " + image.string());
  }
  ::close(control);
  ::close(file);
  if (loop < 0) throw std::runtime_error("no loop device is free");
  return loop;
}

void runTool(const std::vector<std::string>& command,
             const std::vector<std::string>& environment = {}) {
  const Finished finished = run(command, environment);
  if (finished.exit != 0) throw std::runtime_error(command.front() + ": " + finished.err);
}

}  // namespace

std::string whyNoFileSystems() {
  if (::geteuid() != 0) return "not root";
  for (const char* device : {"/dev/fuse", "/dev/loop-control"})
    if (::access(device, R_OK | W_OK) != 0) return std::string("no ") + device;
  for (const char* tool : {"/sbin/mkfs.ext4", "/sbin/mkfs.xfs"})
    if (::access(tool, X_OK) != 0) return std::string("no ") + tool;
  return {};
}

const char* name(FileSystem f) { return f == FileSystem::kExt4 ? "ext4" : "xfs"; }

void makeFileSystem(FileSystem kind, const fs::path& image) {
  writeFile(image, "");
  fs::resize_file(image, 24 << 20);
  if (kind == FileSystem::kExt4)
    runTool({"/sbin/mkfs.ext4", "-q", "-F", "-J", "size=4", image.string()});
  else  // so small a one is made only for those who test XFS
    runTool({"/sbin/mkfs.xfs", "-q", "-f", image.string()},
            {"TEST_DIR=1", "TEST_DEV=1", "QA_CHECK_FS=1"});
}

LoopMount::LoopMount(const fs::path& image, FileSystem kind, const fs::path& folder)
    : folder_(folder) {
  fs::create_directories(folder);
  std::string device;
  loop_ = attach(image, &device);
  // Copies of one XFS share its identity.
  const char* options = kind == FileSystem::kXfs ? "nouuid" : "";
  if (::mount(device.c_str(), folder.c_str(), name(kind), 0, options) == 0) return;
  const int error = errno;
  ::close(loop_);
  errno = error;
  failSystem("mounting " + image.string());
}

// Closing the last descriptor frees the device (autoclear).
LoopMount::~LoopMount() {
  if (::umount2(folder_.c_str(), 0) != 0) ::umount2(folder_.c_str(), MNT_DETACH);
  ::close(loop_);
}

LoggedMount::LoggedMount(FileSystem kind, const fs::path& folder) : folder_(folder) {
  fs::create_directories(folder / "fuse");
  makeFileSystem(kind, folder / "base.img");
  int ready[2];
  if (::pipe2(ready, O_CLOEXEC) != 0) failSystem("making a pipe");
  const int inherited = ::dup(ready[1]);
  ::close(ready[1]);
  disk_ = std::make_unique<Child>(std::vector<std::string>{
      (programFolder() / "logged_disk").string(), (folder / "base.img").string(),
      (folder / "log").string(), std::to_string(inherited), (folder / "fuse").string()});
  ::close(inherited);
  char byte = 0;
  const bool is_ready = ::read(ready[0], &byte, 1) == 1;
  ::close(ready[0]);
  if (!is_ready) throw std::runtime_error("logged_disk: " + disk_->wait().err);
  mounted_ = std::make_unique<LoopMount>(folder / "fuse" / "disk", kind, folder / "mounted");
}

LoggedMount::~LoggedMount() {
  mounted_.reset();
  ::umount2((folder_ / "fuse").c_str(), MNT_DETACH);
}

void LoggedMount::end() {
  mounted_.reset();
  if (::umount2((folder_ / "fuse").c_str(), 0) != 0) failSystem("unmounting the logged disk");
  const Finished finished = disk_->wait();
  if (finished.exit != 0) throw std::runtime_error("logged_disk: " + finished.err);
}

}  // namespace patina::testing
