// SPDX-License-Identifier: GPL-3.0-or-later
// The supervisor's half: when it may be called, and what it leaves behind.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <map>
#include <string>

#include "db/power_cut.h"
#include "processing/image/random.h"
#include "tests/support/temp_folder.h"

namespace patina::db {
namespace {

using testing::TempFolder;
using Mode = FileOps::Mode;

std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& item : std::filesystem::recursive_directory_iterator(folder))
    all[item.path().lexically_relative(folder)] =
        item.is_directory() ? "folder" : testing::readFile(item.path());
  return all;
}

// A life of seeded changes, synced or not, that ends without warning.
void live(const std::filesystem::path& folder, const std::filesystem::path& log,
          std::uint64_t seed) {
  PowerCutFiles files(realFileOps(), log);
  std::uint64_t draws = 0;
  const auto draw = [&](std::uint64_t below) {
    return uniformBelow(hashSeed(seed, draws++), below);
  };
  for (int i = 0; i < 120; ++i) {
    const auto a = folder / std::to_string(draw(6)), b = folder / "sub" / std::to_string(draw(6));
    std::unique_ptr<File> file;
    switch (draw(8)) {
      case 0:
        files.makeFolder(folder / "sub");
        break;
      case 1:
        files.renameNoReplace(a, b);
        break;
      case 2:
        files.renameReplace(b, a);
        break;
      case 3:
        files.remove(draw(2) == 0 ? a : b);
        break;
      case 4:
        files.syncFolder(draw(2) == 0 ? folder : folder / "sub");
        break;
      default:
        if (files.open(draw(2) == 0 ? a : b, Mode::kAppend, &file) != 0) break;
        for (std::uint64_t k = draw(4) + 1; k > 0; --k) {
          const std::string text(draw(3000), static_cast<char>('a' + draw(26)));
          file->write(std::as_bytes(std::span(text)), static_cast<std::int64_t>(draw(5000)));
        }
        if (draw(4) == 0) file->truncate(static_cast<std::int64_t>(draw(5000)));
        if (draw(2) == 0) file->sync();
    }
  }
}

TEST(CutPower, GivesTheSameFolderForTheSameSeedAndDoesNothingTwice) {
  int different = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const TempFolder top = TempFolder::inMemory();
    std::map<std::string, std::string> first;
    for (const std::string name : {"x", "y"}) {
      std::filesystem::create_directory(top / name);
      live(top / name, top / (name + "-log"), seed);
      const auto before = contents(top / name);
      cutPower(top / (name + "-log"), seed);
      const auto after = contents(top / name);
      different += after != before;
      EXPECT_EQ(cutPower(top / (name + "-log"), seed + 1).writes, 0);
      EXPECT_EQ(contents(top / name), after);
      if (first.empty()) first = after;
    }
    std::filesystem::remove_all(top / "x");
  }
  EXPECT_GT(different, 20);
}

// A supervisor that dies before its k-th change to the disk; whether it did.
bool dieAtChange(const std::filesystem::path& log, std::uint64_t seed, int k) {
  const pid_t supervisor = ::fork();
  if (supervisor == 0) {
    cutPower(log, seed, [&k] {
      if (k-- == 0) ::raise(SIGKILL);
    });
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(supervisor, &status, 0);
  return WIFSIGNALED(status);
}

// The second call must end where an undisturbed one does.
TEST(CutPower, EndsInTheSamePlaceWhenItIsKilledInTheMiddle) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const TempFolder top = TempFolder::inMemory();
    const auto folder = top / "archive", log = top / "log";
    std::filesystem::create_directory(folder);
    live(folder, log, seed);
    int changes = 0;
    cutPower(log, seed, [&changes] { ++changes; });
    const auto undisturbed = contents(folder);

    std::filesystem::remove_all(folder);
    std::filesystem::create_directory(folder);
    live(folder, log, seed);
    const auto k =
        static_cast<int>(uniformBelow(hashSeed(seed, 1), static_cast<std::uint64_t>(changes)));
    EXPECT_TRUE(dieAtChange(log, seed, k)) << "seed " << seed << " change " << k;
    cutPower(log, k == 0 ? seed : seed + 1);  // it knows the seed from its first change on
    EXPECT_TRUE(contents(folder) == undisturbed) << "seed " << seed << " change " << k;
  }
}

TEST(CutPower, FindsNothingToDoInAnEmptyLog) {
  const TempFolder log = TempFolder::inMemory();
  const CutReport report = cutPower(log.path(), 1);
  EXPECT_EQ(report.writes + report.names, 0);
}

}  // namespace
}  // namespace patina::db
