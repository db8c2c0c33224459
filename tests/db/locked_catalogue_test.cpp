// SPDX-License-Identifier: GPL-3.0-or-later
// Another process holds the catalogue's write lock for 40 s: everything that is asked meanwhile
// gets a clear answer after its patience, and afterwards the same Archive goes on with nothing
// lost. SQLite's waiting is virtual here: the VFS below ours is one that only counts.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <chrono>
#include <cstring>
#include <optional>

#include "db/archive.h"
#include "db/database.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using namespace std::chrono_literals;
using patina::testing::TempFolder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// SQLite's "unix" VFS with a sleep that takes no time, in its place while this lives.
class VirtualSleep {
 public:
  VirtualSleep() : real_(sqlite3_vfs_find("unix")), vfs_(*real_) {
    active = this;
    vfs_.pNext = nullptr;
    vfs_.xSleep = [](sqlite3_vfs*, int microseconds) {
      active->slept_ += std::chrono::microseconds(microseconds);
      if (active->slept_ >= active->release_at_) active->release_.reset();
      return microseconds;
    };
    sqlite3_vfs_register(&vfs_, 1);
  }
  ~VirtualSleep() {
    sqlite3_vfs_unregister(&vfs_);
    sqlite3_vfs_register(real_, 1);
  }
  VirtualSleep(const VirtualSleep&) = delete;
  VirtualSleep& operator=(const VirtualSleep&) = delete;

  Nanoseconds slept() const { return slept_; }
  // Another connection takes the write lock, and lets go after so much waiting of ours.
  void holdLock(const std::filesystem::path& catalogue, Nanoseconds held) {
    release_at_ = slept_ + held;
    release_.emplace(catalogue);
  }

 private:
  struct Holder {
    explicit Holder(const std::filesystem::path& catalogue)
        : database(catalogue, Database::Access::kWrite, realFileOps()), transaction(database) {}
    Database database;
    Transaction transaction;
  };
  static inline VirtualSleep* active = nullptr;
  sqlite3_vfs* real_;
  sqlite3_vfs vfs_;
  Nanoseconds slept_{}, release_at_{};
  std::optional<Holder> release_;
};

TEST(LockedCatalogue, AnswersClearlyForFortySecondsAndThenGoesOn) {
  const TempFolder folder = TempFolder::inMemory();
  const auto path = folder / "archive";
  VirtualSleep sleep;
  std::size_t acked = 0;
  int refused = 0;
  {
    Archive archive(optionsFor(path));
    beginRun(archive);
    acked += capture(archive, 0, 1).size();
    sleep.holdLock(path / "catalog.sqlite", 40s);
    for (std::int64_t number = 1; number < 30; ++number) try {
        acked += capture(archive, number, static_cast<std::uint64_t>(number)).size();
      } catch (const ArchiveError& e) {
        ++refused;
        EXPECT_EQ(e.exit(), Exit::kTemporary) << e.what();
        EXPECT_THAT(e.what(), HasSubstr("locked"));
        EXPECT_LT(sleep.slept(), 41s) << "nobody holds it any more";
      }
    EXPECT_GE(sleep.slept(), 40s);
    EXPECT_GE(refused, 4);
    EXPECT_GT(acked, 10u);
  }
  const Archive archive(optionsFor(path));
  std::size_t kept = 0;
  archive.reader().eachFrame(kRunId, [&](const auto&) { ++kept; });
  EXPECT_EQ(kept, acked);
  Progress silent;
  EXPECT_THAT(verify(path, silent).problems, IsEmpty());
}

}  // namespace
}  // namespace patina::db::testing
