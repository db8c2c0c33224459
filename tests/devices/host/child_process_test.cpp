// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>

#include "devices/host/channel.h"
#include "tests/support/matchers.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using ::testing::HasSubstr;

// Runs a shell script whose descriptor 3 is the channel, and gives back what it wrote there.
std::string said(const std::string& script, std::shared_ptr<const DriverHome> home = nullptr) {
  auto ends = makeChannelEnds();
  auto child = ChildProcess::start({"/bin/sh", "-c", script, "sh"}, ends->theirs, std::move(home));
  EXPECT_TRUE(child);
  ends->theirs = Descriptor();
  std::string text;
  char buffer[512];
  for (ssize_t n = 0; (n = read(ends->ours.fd(), buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(n));
  return text;
}

TEST(ChildProcess, HasItsChannelAndNoOtherDescriptor) {
  int leak[2];
  ASSERT_EQ(pipe(leak), 0);  // as a careless library would open one
  // ls itself has one more, of the folder it reads.
  EXPECT_EQ(said("ls /proc/self/fd | tr '\\n' ' ' >&3"), "0 1 2 3 4 ");
  close(leak[0]);
  close(leak[1]);
}

TEST(ChildProcess, HasAHomeOfItsOwnThatGoesWithIt) {
  const std::string home =
      said("printf %s \"$HOME\" >&3; test -w \"$HOME\" || printf ' closed' >&3");
  EXPECT_THAT(home, HasSubstr("patina-driver-"));
  EXPECT_FALSE(std::filesystem::exists(home));
}

TEST(ChildProcess, FindsTheNotesOfTheOneBefore) {
  std::filesystem::path folder;
  {
    const auto home = DriverHome::make();
    ASSERT_TRUE(home);
    folder = (*home)->path();
    EXPECT_EQ(said("echo learned > \"$PATINA_DRIVER_NOTES/x\"", *home), "");
    EXPECT_EQ(said("cat \"$PATINA_DRIVER_NOTES/x\" >&3", *home), "learned\n");
  }
  EXPECT_FALSE(std::filesystem::exists(folder));
}

TEST(ChildProcess, IsToldWhereItsChannelIs) {
  EXPECT_EQ(said("printf '%s %s' \"$@\" >&3"), "--fd 3");
}

TEST(ChildProcess, IsNoPartOfOurProcessGroup) {
  // A terminal's Ctrl-C is for us alone.
  EXPECT_NE(said("ps -o pgid= -p $$ | tr -d ' ' >&3"), std::to_string(getpgrp()));
}

TEST(ChildProcess, IsKilledWhateverItDoes) {
  auto ends = makeChannelEnds();
  auto child = ChildProcess::start({"/bin/sh", "-c", "trap '' TERM HUP INT; sleep 1000", "sh"},
                                   ends->theirs);
  ASSERT_TRUE(child);
  const pid_t pid = (*child)->pid();
  EXPECT_EQ(::kill(pid, 0), 0);
  (*child)->kill();
  EXPECT_TRUE((*child)->ended());
  EXPECT_NE(::kill(pid, 0), 0);
}

TEST(ChildProcess, AProgramThatIsNotThereIsAnError) {
  auto ends = makeChannelEnds();
  const auto child = ChildProcess::start({"/nowhere/patina"}, ends->theirs);
  EXPECT_THAT(child, Fails(Errc::kLost));
  EXPECT_THAT(child.error().what, HasSubstr("/nowhere/patina"));
}

}  // namespace
}  // namespace patina::devices::host
