// SPDX-License-Identifier: GPL-3.0-or-later
// Time-varying textures: what the reader takes of a file that HDF5 opens.
#include <sys/mman.h>
#include <unistd.h>

#include "processing/ttf/ttf_file.h"
#include "tests/fuzz/targets.h"

namespace patina::testing {
namespace {

// A file without a name, filled anew for every run.
class MemoryFile {
 public:
  MemoryFile() : fd_(memfd_create("ttf", MFD_CLOEXEC)) { PATINA_CHECK(fd_ >= 0); }
  std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }
  void fill(std::span<const std::byte> bytes) const {
    PATINA_CHECK(ftruncate(fd_, 0) == 0);
    PATINA_CHECK(pwrite(fd_, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
  }

 private:
  int fd_;  // as long as the process
};

}  // namespace

void fuzzTtf(std::span<const std::byte> bytes) {
  static const MemoryFile kFile;
  kFile.fill(bytes);
  try {
    const ttf::TtfReader reader(kFile.path());
    const ttf::TtfInfo& info = reader.info();
    PATINA_CHECK(info.time_s.size() == static_cast<std::size_t>(info.frames));
    const auto samples = static_cast<std::int64_t>(info.width) * info.height * info.channels;
    if (samples > 1'000'000) return;  // the claim alone is no fault
    reader.frame(info.frames - 1);
    reader.linearFrame(0);
    reader.block(0, 1, {0, 0, 1, 1});
  } catch (const ProcessingError&) {
    // Refused, with why.
  }
}

}  // namespace patina::testing
