// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes that rot: catalogue, WAL, shared memory and journals are damaged at seeded places under a
// dead process. Opening answers a clear error or goes on; no frame is written over; and `rebuild`
// brings back every frame that was acknowledged.
// PATINA_DAMAGES is how often; the long form sets it.
#include <gmock/gmock.h>

#include <cstdio>
#include <cstdlib>
#include <map>

#include "db/archive.h"
#include "processing/image/random.h"
#include "tests/support/disk/archive_life.h"
#include "tests/support/temp_folder.h"

namespace patina::db {
namespace {

namespace fs = std::filesystem;
using testing::Acked;
using ::testing::IsEmpty;
using testing::Judge;
using testing::liveOn;
using testing::readFile;
using testing::TempFolder;
using testing::writeFile;

int damagesAskedFor() {
  const char* text = std::getenv("PATINA_DAMAGES");
  return text != nullptr ? std::atoi(text) : 80;
}

const char* const kTargets[] = {"catalog.sqlite", "catalog.sqlite-wal", "catalog.sqlite-shm",
                                "journal/20240501T120000Z-victim.jsonl", "journal/_archive.jsonl"};

class DamagedArchive : public ::testing::Test {
 protected:
  // An archive as a process leaves it that dies after an acknowledgement: rows in catalogue and
  // WAL.
  DamagedArchive() {
    liveOn(optionsOf(folder_ / "lived"), 4, 1, [this](const Acked& a) { judge_.note(a); });
    liveOn(optionsOf(folder_ / "lived"), 4, 1, [this](const Acked& a) {
      judge_.note(a);
      fs::remove_all(whole_);
      fs::copy(folder_ / "lived", whole_, fs::copy_options::recursive);
      fs::remove(whole_ / "reserve");  // a megabyte that nobody reads
    });
    for (const auto& entry : fs::recursive_directory_iterator(whole_ / "frames"))
      if (entry.is_regular_file()) frames_[fs::relative(entry, whole_)] = readFile(entry.path());
  }

  static ArchiveOptions optionsOf(const fs::path& folder) {
    ArchiveOptions options;
    options.folder = folder;
    return options;
  }

  static std::string damaged(std::string bytes, std::uint64_t seed) {
    if (bytes.empty()) return bytes;
    const std::size_t at = uniformBelow(hashSeed(seed, 1), bytes.size());
    switch (hashSeed(seed, 2) % 8) {
      case 0:  // the tail is gone
        bytes.resize(at);
        break;
      case 1:  // a block came back empty
        for (std::size_t i = at; i < std::min(at + 4096, bytes.size()); ++i) bytes[i] = 0;
        break;
      default:
        for (std::uint64_t i = 0; i < 1 + hashSeed(seed, 3) % 16; ++i)
          bytes[(at + i * 31) % bytes.size()] ^= static_cast<char>(1 + hashSeed(seed, 4, i) % 255);
    }
    return bytes;
  }

  // What a process does that finds the archive so; a clear error is an answer.
  void goOn(Judge& judge) {
    try {
      liveOn(optionsOf(archive_), 1, 1, [&](const Acked& a) { judge.note(a); });
      ++opened_;
    } catch (const Failure& e) {
      EXPECT_NE(e.exit(), Exit::kBug) << e.what();
      EXPECT_GT(std::string(e.what()).size(), 10u);
    }
  }

  void damageOnce(std::uint64_t seed) {
    const fs::path target = kTargets[hashSeed(seed, 5) % std::size(kTargets)];
    SCOPED_TRACE("damage " + std::to_string(seed) + " of " + target.string());
    fs::remove_all(archive_);
    fs::copy(whole_, archive_, fs::copy_options::recursive);
    writeFile(archive_ / target, damaged(readFile(archive_ / target), seed));
    Judge judge = judge_;
    goOn(judge);
    Progress silent;
    rebuild(archive_, silent);
    EXPECT_THAT(judge.judgeRecovered(archive_), IsEmpty());
    for (const auto& [name, bytes] : frames_)
      EXPECT_EQ(readFile(archive_ / name), bytes) << name << " was written over";
  }

  TempFolder folder_ = TempFolder::inMemory();
  fs::path whole_ = folder_ / "whole", archive_ = folder_ / "archive";
  Judge judge_;
  std::map<fs::path, std::string> frames_;
  int opened_ = 0;
};

TEST_F(DamagedArchive, ComesBackWithEveryAcknowledgedFrame) {
  const int damages = damagesAskedFor();
  for (int seed = 0; seed < damages && !HasFailure(); ++seed) {
    try {
      damageOnce(static_cast<std::uint64_t>(seed));
    } catch (const std::exception& e) {
      ADD_FAILURE() << "damage " << seed << ": " << e.what();
    }
  }
  std::printf("%d damages, %d of them let a process go on; %zu frames, 0 lost after rebuild\n",
              damages, opened_, judge_.count());
}

}  // namespace
}  // namespace patina::db
