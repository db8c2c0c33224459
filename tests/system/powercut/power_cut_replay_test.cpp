// SPDX-License-Identifier: GPL-3.0-or-later
// Power cuts under `patina` on ext4 and XFS: the program runs once on a disk that logs its writes
// and flushes, then the disk is put together as a cut at a seeded place would have left it, mounted
// and judged: before recovery (frames and catalogue as they lie there), and after.
// PATINA_BLOCK_CUTS is the number of cuts; `make test-powercut` sets it.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "db/database.h"
#include "processing/image/random.h"
#include "tests/support/places.h"
#include "tests/system/powercut/disk_log.h"
#include "tests/system/powercut/loop_mount.h"
#include "tests/system/victim.h"

namespace patina::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::IsEmpty;

constexpr int kCutsALife = 125;

int cutsAskedFor() {
  const char* text = std::getenv("PATINA_BLOCK_CUTS");
  return text != nullptr ? std::atoi(text) : 12;
}

struct Verdict {
  std::vector<std::string> lost, corrupt;
};

class PowerCutReplay : public ::testing::Test {
 protected:
  void SetUp() override {
    if (const std::string why = whyNoFileSystems(); !why.empty())
      GTEST_SKIP() << "no file system can be made and mounted here: " << why;
    plan_ = writeVictimPlan(folder_.path(), "2s");
  }

  // Runs the victims one after another on a fresh logged disk; answers how they ended.
  struct Life {
    std::vector<std::string> command;
    int exit = 0;  // -1: killed, as it should be
  };
  void live(FileSystem kind, const std::vector<Life>& lives) {
    fs::remove_all(work_);
    LoggedMount disk(kind, work_);
    for (const Life& life : lives) {
      const int mark = ::open((work_ / "fuse" / "mark").c_str(), O_WRONLY | O_APPEND);
      ASSERT_GE(mark, 0);
      std::vector<std::string> command = life.command;
      const std::string archive = (work_ / "mounted" / "archive").string();
      command.insert(command.end(), {"--archive", archive, "--log-acks"});
      command.push_back(std::to_string(mark));
      const Finished finished = run(command);
      ::close(mark);
      ASSERT_EQ(finished.exit, life.exit) << finished.err;
    }
    disk.end();
  }
  Life patina(const std::string& verb) const {
    return {{program().string(), verb, plan_.string(), "--quiet"}};
  }
  static Life session(const std::vector<std::string>& more, const std::string& duration = "2s",
                      int exit = 0) {
    Life life{{(programFolder() / "session_victim").string(), "--duration", duration}, exit};
    life.command.insert(life.command.end(), more.begin(), more.end());
    return life;
  }

  // Judges `cuts` seeded cuts of the last life; stops when `each` answers false.
  void cut(FileSystem kind, int cuts, std::uint64_t seed,
           const std::function<bool(const Verdict&)>& each) {
    DiskReplay replay(work_ / "base.img", work_ / "log");
    std::vector<std::size_t> places;
    for (int i = 0; i < cuts; ++i)
      places.push_back(1 + uniformBelow(hashSeed(seed, i), replay.records()));
    std::ranges::sort(places);
    Judge judge;
    std::size_t told = 0;
    for (int i = 0; i < cuts; ++i) {
      replay.forwardTo(places[static_cast<std::size_t>(i)]);
      for (; told < replay.marks().size(); ++told) judge.note(parseAck(replay.marks()[told]));
      writeFile(work_ / "cut.img", replay.cut(hashSeed(seed, i, 1)));
      acked_ += judge.count();
      if (!each(judgeImage(kind, judge))) return;
    }
  }

  Verdict judgeImage(FileSystem kind, const Judge& judge) const {
    Verdict verdict;
    const fs::path archive = work_ / "seen" / "archive";
    const LoopMount mounted(work_ / "cut.img", kind, work_ / "seen");
    if (!fs::exists(archive / "catalog.sqlite")) {
      if (judge.count() > 0) verdict.lost.push_back("the catalogue is gone");
      return verdict;
    }
    try {
      if (judge.count() > 0) {
        checkCatalogue(archive, verdict);
        for (const auto& p : judge.judgeCatalogue(archive))
          verdict.lost.push_back("before recovery: " + p);
      }
      db::ArchiveOptions options;
      options.folder = archive;
      options.owner = "power cut replay";
      { const db::Archive recovered(options); }
      checkCatalogue(archive, verdict);
      for (const auto& p : judge.judgeRecovered(archive))
        verdict.lost.push_back("after recovery: " + p);
    } catch (const Failure& e) {
      verdict.corrupt.push_back(e.what());
    }
    return verdict;
  }

  static void checkCatalogue(const fs::path& archive, Verdict& verdict) {
    db::Database database(archive / "catalog.sqlite", db::Database::Access::kWrite,
                          db::realFileOps());
    db::Statement check(database, "PRAGMA integrity_check");
    if (check.step() && check.text(0) != "ok") verdict.corrupt.emplace_back(check.text(0));
  }

  // How many cuts it takes until a mutant is caught, out of 20; 0: it was not.
  int cutsUntilCaught(const std::string& mutant) {
    // So long that SQLite begins its WAL again: while the WAL grows, its sync carries names along.
    live(FileSystem::kExt4, {session({"--mutant", mutant}, "8s")});
    int done = 0, caught = 0;
    if (HasFatalFailure()) return 0;
    cut(FileSystem::kExt4, 20, 7, [&](const Verdict& verdict) {
      ++done;
      if (!verdict.lost.empty() || !verdict.corrupt.empty()) caught = done;
      return caught == 0;
    });
    std::printf("%s: caught at cut %d of 20\n", mutant.c_str(), caught);
    return caught;
  }

  TempFolder folder_ = TempFolder::inMemory();
  fs::path work_ = folder_ / "work", plan_;
  std::size_t acked_ = 0;  // summed over the cuts
};

TEST_F(PowerCutReplay, LosesNothingThatWasAcknowledged) {
  const int cuts = cutsAskedFor();
  const int lives = (cuts + kCutsALife - 1) / kCutsALife + 1;
  int done = 0;
  for (int life = 0; done < cuts; ++life) {
    const FileSystem kind = life % 2 == 0 ? FileSystem::kExt4 : FileSystem::kXfs;
    SCOPED_TRACE(std::string(name(kind)) + ", life " + std::to_string(life));
    // In virtual time, in real time, and a recovery after a kill among them.
    if (life % 3 == 0) live(kind, {patina("rehearse")});
    if (life % 3 == 1) live(kind, {session({"--die-at", "renamed:20"}, "2s", -1), session({})});
    if (life % 3 == 2) live(kind, {patina("capture")});
    if (HasFatalFailure()) return;
    const int now = std::min({kCutsALife, cuts - done, (cuts + lives - 1) / lives});
    cut(kind, now, hashSeed(1, life), [&](const Verdict& verdict) {
      EXPECT_THAT(verdict.lost, IsEmpty()) << "cut " << done;
      EXPECT_THAT(verdict.corrupt, IsEmpty()) << "cut " << done;
      ++done;
      return !HasFailure();
    });
    if (HasFailure()) return;
    std::printf("%s, life %d: %d cuts so far\n", name(kind), life, done);
    std::fflush(stdout);
  }
  std::printf("%d cuts, %zu acknowledged frames looked for, 0 lost, 0 corrupt catalogues\n", done,
              acked_);
  EXPECT_GT(acked_, static_cast<std::size_t>(cuts));
}

TEST_F(PowerCutReplay, CatchesAMissingFileSync) { EXPECT_GT(cutsUntilCaught("no_file_sync"), 0); }

TEST_F(PowerCutReplay, CatchesAMissingFolderSync) {
  EXPECT_GT(cutsUntilCaught("no_folder_sync"), 0);
}

TEST_F(PowerCutReplay, CatchesSynchronousNormal) {
  EXPECT_GT(cutsUntilCaught("synchronous_normal"), 0);
}

}  // namespace
}  // namespace patina::testing
