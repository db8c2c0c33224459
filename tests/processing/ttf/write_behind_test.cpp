// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/write_behind.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <vector>

#include "tests/support/temp_folder.h"

namespace patina::ttf {
namespace {

using testing::TempFolder;

constexpr std::int64_t kPiece = 1 << 20;

// Share of the file's bytes [first, end) that the system keeps in memory.
double keptOf(int fd, std::int64_t first, std::int64_t end) {
  const long page = ::sysconf(_SC_PAGESIZE);
  const auto length = static_cast<std::size_t>(end - first);
  void* mapped = ::mmap(nullptr, length, PROT_READ, MAP_SHARED, fd, first);
  std::vector<unsigned char> pages(length / static_cast<std::size_t>(page));
  EXPECT_EQ(::mincore(mapped, length, pages.data()), 0);
  ::munmap(mapped, length);
  double kept = 0;
  for (unsigned char p : pages) kept += p & 1;
  return kept / static_cast<double>(pages.size());
}

TEST(WriteBehind, KeepsOfALargeFileItsEndInMemory) {
  const TempFolder folder;
  const int fd = ::open((folder / "large").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  struct statfs system {};
  ASSERT_EQ(::fstatfs(fd, &system), 0);
  if (system.f_type == TMPFS_MAGIC) GTEST_SKIP() << "no disk here";
  const std::vector<char> bytes(kPiece / 4, 'p');
  WriteBehind behind(kPiece, 4 * kPiece);
  for (int i = 0; i < 64; ++i) {  // 16 pieces
    ASSERT_EQ(::write(fd, bytes.data(), bytes.size()), kPiece / 4);
    ASSERT_EQ(behind.wrote(fd, kPiece / 4), 0);
  }
  EXPECT_LT(keptOf(fd, 0, 12 * kPiece), 0.1);
  EXPECT_GT(keptOf(fd, 12 * kPiece, 16 * kPiece), 0.9);
  ::close(fd);
}

TEST(WriteBehind, LeavesSmallFilesAndWhatIsNoFileAlone) {
  const TempFolder folder;
  const int fd = ::open((folder / "small").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  const std::vector<char> bytes(kPiece, 'p');
  WriteBehind behind(kPiece, 4 * kPiece), of_pipe(1, 1);
  for (int i = 0; i < 4; ++i) {
    ASSERT_EQ(::write(fd, bytes.data(), bytes.size()), kPiece);
    ASSERT_EQ(behind.wrote(fd, kPiece), 0);
  }
  EXPECT_EQ(keptOf(fd, 0, 4 * kPiece), 1.0);
  ::close(fd);
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  EXPECT_EQ(of_pipe.wrote(ends[1], 10), 0);
  EXPECT_EQ(of_pipe.wrote(-1, 10), 0);
  ::close(ends[0]);
  ::close(ends[1]);
}

}  // namespace
}  // namespace patina::ttf
