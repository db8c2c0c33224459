// SPDX-License-Identifier: GPL-3.0-or-later
// The promise of the archive under seeded power cuts: a child commits frames and dies at a seeded
// call of the disk, the unsynced is taken back, and everything it acknowledged must be there.
// PATINA_POWER_CUTS is the number of cuts of each of the four series; the long form sets it.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "db/archive.h"
#include "db/power_cut.h"
#include "processing/image/random.h"
#include "tests/support/disk/archive_life.h"
#include "tests/support/disk/failing_file_ops.h"
#include "tests/support/temp_folder.h"

namespace patina::db {
namespace {

using testing::Acked;
using testing::FailingFileOps;
using testing::Judge;
using testing::TempFolder;
using Mutant = ArchiveOptions::Mutant;
using ::testing::ElementsAre;

constexpr int kCutsAnArchive = 25;

// An archive that lives through one cut after another.
class Victim {
 public:
  Victim(Mutant mutant, std::uint64_t seed) : mutant_(mutant), seed_(seed) {}

  std::filesystem::path archive() const { return top_ / "archive"; }
  std::size_t acked() const { return judge_.count(); }
  int losses() const { return losses_; }

  // What becomes of the archive after the cut: recovered and judged again, or left to the next
  // life, which may die while it recovers.
  enum class Then { kRecover, kLeave };

  // One life and its end; the broken promises.
  std::vector<std::string> liveAndDie(std::uint64_t life, Then then) {
    const std::uint64_t own = hashSeed(seed_, life);
    int ends[2];
    if (::pipe(ends) != 0) return {"no pipe"};
    const pid_t child = ::fork();
    if (child == 0) beVictim(ends, own);
    ::close(ends[1]);
    readAcks(ends[0]);
    ::close(ends[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    if (!WIFSIGNALED(status)) return {"the victim ended by itself: " + std::to_string(status)};

    losses_ += cutPower(top_ / "log", own).writes_lost;
    std::vector<std::string> problems;
    if (std::filesystem::exists(archive() / "catalog.sqlite"))
      problems = judge(then);
    else if (judge_.count() > 0)
      problems.push_back("the catalogue is gone");
    return problems;
  }

 private:
  [[noreturn]] void beVictim(const int (&ends)[2], std::uint64_t own) const {
    ::close(ends[0]);
    try {
      FailingFileOps disk;
      PowerCutFiles files(disk, top_ / "log");
      // Opening takes about a hundred calls, a shot thirty; every third life ends while opening.
      disk.dieAt(1 + static_cast<std::int64_t>(uniformBelow(own, own % 3 == 0 ? 150 : 1500)));
      testing::liveOn(options(&files), 1000, seed_, [&](const Acked& acked) {
        const std::string line = acked.sha256 + " " + std::to_string(acked.step) + " " +
                                 std::to_string(acked.shot) + "\n";
        if (::write(ends[1], line.data(), line.size()) < 0) ::_exit(4);
      });
    } catch (const std::exception& e) {
      std::fprintf(stderr, "victim: %s\n", e.what());
    }
    ::_exit(3);
  }

  void readAcks(int end) {
    std::FILE* acks = ::fdopen(::dup(end), "r");
    char hash[65];
    Acked acked;
    while (std::fscanf(acks, "%64s %ld %d", hash, &acked.step, &acked.shot) == 3) {
      acked.sha256 = hash;
      judge_.note(acked);
    }
    std::fclose(acks);
  }

  std::vector<std::string> judge(Then then) const {
    std::vector<std::string> problems;
    try {
      // Without the folder's sync only recovery is asked: the journal is no witness there.
      // Before the first acknowledgement the catalogue may have no tables yet.
      if (mutant_ != Mutant::kNoFolderSync && judge_.count() > 0)
        problems = judge_.judgeCatalogue(archive());
      for (std::string& problem : problems) problem.insert(0, "before recovery: ");
      if (mutant_ == Mutant::kSynchronousNormal || then == Then::kLeave) return problems;
      { const Archive next(options(&realFileOps())); }
      for (const std::string& problem : judge_.judgeRecovered(archive()))
        problems.push_back("after recovery: " + problem);
    } catch (const Failure& e) {
      problems.push_back(e.what());
    }
    return problems;
  }

  ArchiveOptions options(FileOps* files) const {
    ArchiveOptions options;
    options.folder = archive();
    options.files = files;
    options.owner = "victim";
    options.mutant = mutant_;
    return options;
  }

  Mutant mutant_;
  std::uint64_t seed_;
  TempFolder top_ = TempFolder::inMemory();
  Judge judge_;
  int losses_ = 0;
};

int cutsAskedFor() {
  const char* text = std::getenv("PATINA_POWER_CUTS");
  return text != nullptr ? std::atoi(text) : 75;
}

// How many cuts it takes until a broken promise shows; 0 = none did.
int cutsUntilCaught(Mutant mutant, int cuts) {
  for (int cut = 0; cut < cuts; ++cut) {
    Victim victim(mutant, hashSeed(7, static_cast<std::uint64_t>(cut)));
    if (!victim.liveAndDie(0, Victim::Then::kRecover).empty()) return cut + 1;
  }
  return 0;
}

class PowerCutSeries : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(PowerCutSeries, LosesNothingThatWasAcknowledged) {
  const int cuts = cutsAskedFor();
  std::size_t acked = 0;
  int lost_writes = 0;
  for (int cut = 0; cut < cuts;) {
    Victim victim(Mutant::kNone, hashSeed(GetParam(), static_cast<std::uint64_t>(cut)));
    for (int life = 0; life < kCutsAnArchive && cut < cuts; ++life, ++cut)
      ASSERT_THAT(victim.liveAndDie(static_cast<std::uint64_t>(life),
                                    life % 3 == 2 ? Victim::Then::kRecover : Victim::Then::kLeave),
                  ElementsAre())
          << "cut " << cut << " of a seeded series: it comes again";
    acked += victim.acked();
    lost_writes += victim.losses();
  }
  std::printf("%d cuts, %zu frames acknowledged, 0 lost; %d unsynced writes taken back\n", cuts,
              acked, lost_writes);
  EXPECT_GT(acked, static_cast<std::size_t>(cuts));
  EXPECT_GT(lost_writes, cuts / 2);
}
INSTANTIATE_TEST_SUITE_P(Seeds, PowerCutSeries, ::testing::Values(1u, 2u, 3u, 4u));

TEST(PowerCutCampaign, AccusesNobodyOfTheFullProtocol) {
  EXPECT_EQ(cutsUntilCaught(Mutant::kNone, 20), 0);
}

TEST(PowerCutCampaign, CatchesAMissingFileSync) {
  const int caught = cutsUntilCaught(Mutant::kNoFileSync, 20);
  EXPECT_GT(caught, 0);
  std::printf("no file sync: caught at cut %d\n", caught);
}

TEST(PowerCutCampaign, CatchesAMissingFolderSync) {
  const int caught = cutsUntilCaught(Mutant::kNoFolderSync, 20);
  EXPECT_GT(caught, 0);
  std::printf("no folder sync: caught at cut %d\n", caught);
}

TEST(PowerCutCampaign, CatchesSynchronousNormal) {
  const int caught = cutsUntilCaught(Mutant::kSynchronousNormal, 20);
  EXPECT_GT(caught, 0);
  std::printf("synchronous=NORMAL: caught at cut %d\n", caught);
}

}  // namespace
}  // namespace patina::db
