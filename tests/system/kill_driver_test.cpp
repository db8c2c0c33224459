// SPDX-License-Identifier: GPL-3.0-or-later
// SIGKILL at random times and at every named point of the commit. PATINA_KILLS is the number for
// each victim, 25 unless set; PATINA_VICTIM, a command line with the words {archive} and {acks},
// is killed too when it is set.
#include "tests/system/kill_driver.h"

#include <gmock/gmock.h>

#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "processing/image/random.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

using ::testing::IsEmpty;

constexpr int kKillsAnArchive = 25;

int killsAskedFor() {
  const char* text = std::getenv("PATINA_KILLS");
  return text != nullptr ? std::atoi(text) : 25;
}

// Kills `program` so often, on an archive that is made afresh now and then.
void killOverAndOver(const VictimProgram& program, int kills, std::uint64_t seed) {
  std::size_t acked = 0;
  int at_points = 0;
  Nanoseconds slowest{};
  for (int done = 0; done < kills;) {
    KillDriver driver(program, hashSeed(seed, done));
    for (int round = 0; round < kKillsAnArchive && done < kills; ++round, ++done)
      ASSERT_THAT(driver.kill(done), IsEmpty()) << "kill " << done << " of seed " << seed;
    acked += driver.acked();
    at_points += driver.at_points();
    slowest = std::max(slowest, driver.slowestStart());
  }
  std::printf(
      "%d kills, %d of them at named points; %zu frames acknowledged, 0 lost, 0 doubled; "
      "capturing again within %.2f s\n",
      kills, at_points, acked, std::chrono::duration<double>(slowest).count());
  EXPECT_GT(acked, static_cast<std::size_t>(kills));
  EXPECT_LT(slowest, std::chrono::seconds(10));
}

VictimProgram victim(const std::string& name, const std::string& clock) {
  return {{(programFolder() / name).string(), "--archive", "{archive}", "--log-acks", "{acks}",
           "--clock", clock},
          true};
}

TEST(KillDriver, FindsNothingLostInAnArchiveOfNoise) {
  killOverAndOver(victim("commit_victim", "none"), killsAskedFor(), 1);
}

TEST(KillDriver, FindsEveryStepOnceInASession) {
  killOverAndOver(victim("session_victim", "virtual"), killsAskedFor(), 2);
}

TEST(KillDriver, FindsEveryStepOnceInASessionInRealTime) {
  killOverAndOver(victim("session_victim", "real"), killsAskedFor() / 3, 3);
}

// `patina` itself, as its user runs it: `words` before the plan, in virtual or real time.
void killPatina(const std::vector<std::string>& words, int kills, std::uint64_t seed) {
  const TempFolder folder = TempFolder::inMemory();
  setenv("RUNTIME_DIRECTORY", (folder / "run").c_str(), 1);  // of the daemon's socket
  writeFile(folder / "rig.toml", R"(name = "bench"
[[camera]]
id = "cam0"
backend = "twin"
settings = { format = "jpeg" }
[[light]]
id = "key"
backend = "twin"
between = "on"
[twin]
specimen = "grey_card"
size = "64x48"
)");
  writeFile(folder / "plan.toml", R"(rig = "rig.toml"
specimen = "card"
interval = "50ms"
duration = "24h"
[[sweep]]
lights = [["key"]]
exposures = ["1/100"]
)");
  std::vector<std::string> command = {program().string()};
  command.insert(command.end(), words.begin(), words.end());
  for (const std::string& word :
       {(folder / "plan.toml").string(), std::string("--archive"), std::string("{archive}"),
        std::string("--log-acks"), std::string("{acks}"), std::string("--quiet")})
    command.push_back(word);
  killOverAndOver({command}, kills, seed);
  unsetenv("RUNTIME_DIRECTORY");
}

TEST(KillDriver, FindsNothingLostInARehearsal) { killPatina({"rehearse"}, killsAskedFor() / 3, 5); }

TEST(KillDriver, FindsNothingLostInACapture) { killPatina({"capture"}, killsAskedFor() / 3, 6); }

TEST(KillDriver, FindsNothingLostInTheDaemon) {
  killPatina({"daemon", "--port", "0", "--start"}, killsAskedFor() / 3, 7);
}

TEST(KillDriver, KillsTheVictimItIsGiven) {
  const char* text = std::getenv("PATINA_VICTIM");
  if (text == nullptr) GTEST_SKIP() << "PATINA_VICTIM is unset";
  VictimProgram program;
  std::istringstream words(text);
  for (std::string word; words >> word;) program.command.push_back(word);
  killOverAndOver(program, killsAskedFor(), 4);
}

}  // namespace
}  // namespace patina::testing
