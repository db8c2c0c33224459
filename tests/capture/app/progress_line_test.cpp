// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

TEST(ProgressLine, SaysNothingWhereNobodyWatches) {
  const TempFolder folder = TempFolder::inMemory();
  const Finished finished = runPatina({"rehearse", quickPlan(), "--archive", folder / "a"});
  EXPECT_EQ(finished.err, "");
}

// The terminal's output; the program's own exit is not looked at.
std::string onATerminal(std::vector<std::string> command) {
  std::vector<char*> words;
  for (std::string& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  int terminal = -1;
  const pid_t pid = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (pid == 0) {
    execv(words[0], words.data());
    _exit(127);
  }
  std::string text;
  char part[4096];
  for (ssize_t n = 0; (n = read(terminal, part, sizeof part)) > 0;)
    text.append(part, static_cast<std::size_t>(n));
  close(terminal);
  waitpid(pid, nullptr, 0);
  return text;
}

TEST(ProgressLine, RewritesOneLineOfATerminalAndLeavesNoTrace) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string text =
      onATerminal({program(), "rehearse", quickPlan(), "--archive", folder / "a"});
  EXPECT_THAT(text, ::testing::HasSubstr("step "));
  EXPECT_THAT(text, ::testing::HasSubstr("\r\033[Krun id"));
  const std::string quiet =
      onATerminal({program(), "rehearse", quickPlan(), "--archive", folder / "b", "--quiet"});
  EXPECT_THAT(quiet, ::testing::Not(::testing::HasSubstr("\033")));
}

}  // namespace
}  // namespace patina::testing
