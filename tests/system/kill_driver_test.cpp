// SPDX-License-Identifier: GPL-3.0-or-later
// SIGKILL at random times and at every named point of the commit. PATINA_KILLS is the number for
// each victim, 8 to 25 unless set; PATINA_VICTIM, a command line with the words {archive} and
// {acks}, is killed too when it is set.
#include "tests/system/kill_driver.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "processing/image/random.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"
#include "tests/system/victim.h"

namespace patina::testing {
namespace {

using ::testing::IsEmpty;

constexpr int kKillsAnArchive = 25;

int killsAskedFor(int unless_set) {
  const char* text = std::getenv("PATINA_KILLS");
  return text != nullptr ? std::atoi(text) : unless_set;
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

std::vector<std::string> wordsOf(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::vector<std::string> commandOf(const std::filesystem::path& program,
                                   const std::string& arguments) {
  std::vector<std::string> command = wordsOf(arguments);
  command.insert(command.begin(), program.string());
  return command;
}

VictimProgram victim(const std::string& name, const std::string& clock) {
  const auto command =
      commandOf(programFolder() / name, "--archive {archive} --log-acks {acks} --clock " + clock);
  return {command, command};
}

TEST(KillDriver, FindsNothingLostInAnArchiveOfNoise) {
  killOverAndOver(victim("commit_victim", "none"), killsAskedFor(25), 1);
}

TEST(KillDriver, FindsEveryStepOnceInASession) {
  killOverAndOver(victim("session_victim", "virtual"), killsAskedFor(25), 2);
}

TEST(KillDriver, FindsEveryStepOnceInASessionInRealTime) {
  killOverAndOver(victim("session_victim", "real"), killsAskedFor(8), 3);
}

// `patina` itself, as its user runs it.
class KillPatina : public ::testing::Test {
 protected:
  KillPatina() { setenv("RUNTIME_DIRECTORY", (folder_ / "run").c_str(), 1); }  // of the socket
  ~KillPatina() override { unsetenv("RUNTIME_DIRECTORY"); }

  std::vector<std::string> command(const std::filesystem::path& program,
                                   const std::string& arguments) const {
    auto command = commandOf(program, arguments + " {plan} --archive {archive} --log-acks {acks}");
    std::ranges::replace(command, "{plan}", plan_.string());
    return command;
  }
  VictimProgram patina(const std::string& arguments) const {
    return {command(program(), arguments + " --quiet"), {}};
  }
  VictimProgram daemon(const std::string& how, const std::string& speed) const {
    return {command(program(), "daemon --quiet --port 0 " + how + " --start"),
            command(programFolder() / "daemon_victim", "--speed " + speed + " --plan")};
  }

  const TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path plan_ = writeVictimPlan(folder_.path(), "24h");
};

TEST_F(KillPatina, FindsNothingLostInARehearsal) {
  killOverAndOver(patina("rehearse"), killsAskedFor(8), 5);
}

TEST_F(KillPatina, FindsNothingLostInACapture) {
  killOverAndOver(patina("capture"), killsAskedFor(8), 6);
}

// In a time that goes fast: less waiting, and as many frames a second as the daemon can commit.
TEST_F(KillPatina, FindsNothingLostInTheDaemon) {
  killOverAndOver(daemon("--rehearse --speed 20", "20"), killsAskedFor(14), 7);
}

TEST_F(KillPatina, FindsNothingLostInTheDaemonInRealTime) {
  killOverAndOver(daemon("", "0"), killsAskedFor(4), 8);
}

TEST(KillDriver, KillsTheVictimItIsGiven) {
  const char* text = std::getenv("PATINA_VICTIM");
  if (text == nullptr) GTEST_SKIP() << "PATINA_VICTIM is unset";
  killOverAndOver({wordsOf(text), {}}, killsAskedFor(25), 4);
}

}  // namespace
}  // namespace patina::testing
