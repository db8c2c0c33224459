// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/mapped_log.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "tests/support/temp_folder.h"

namespace patina::db {
namespace {

using testing::TempFolder;

std::span<const std::byte> bytesOf(const std::string& text) {
  return std::as_bytes(std::span(text));
}
std::string textOf(const MappedLog& log) {
  return {reinterpret_cast<const char*>(log.bytes().data()), log.bytes().size()};
}

TEST(MappedLog, HoldsAfterASigkillWhatWasAppended) {
  const TempFolder folder = TempFolder::inMemory();
  const pid_t writer = ::fork();
  if (writer == 0) {
    MappedLog log(folder.path());
    log.append({bytesOf("one "), bytesOf("entry")});
    ::raise(SIGKILL);
  }
  ::waitpid(writer, nullptr, 0);
  EXPECT_EQ(textOf(MappedLog(folder.path())), "one entry");
}

TEST(MappedLog, GrowsAndIsEmptiedWithoutLosingItsSpace) {
  const TempFolder folder = TempFolder::inMemory();
  MappedLog log(folder.path());
  const std::string page(1 << 16, 'p');
  for (int i = 0; i < 50; ++i) ASSERT_EQ(log.append({bytesOf(page)}), 0);
  EXPECT_EQ(log.bytes().size(), 50u << 16);
  log.empty();
  EXPECT_TRUE(MappedLog(folder.path()).bytes().empty());
  log.append({bytesOf("again")});
  EXPECT_EQ(textOf(MappedLog(folder.path())), "again");
}

TEST(MappedLog, IsExchangedWhole) {
  const TempFolder folder = TempFolder::inMemory();
  MappedLog log(folder.path());
  log.append({bytesOf("old")});
  log.appendBeside({bytesOf("new"), bytesOf("er")});
  EXPECT_EQ(textOf(MappedLog(folder.path())), "old");
  log.exchange();
  EXPECT_EQ(textOf(log), "newer");
  log.append({bytesOf("!")});
  EXPECT_EQ(textOf(MappedLog(folder.path())), "newer!");
}

}  // namespace
}  // namespace patina::db
