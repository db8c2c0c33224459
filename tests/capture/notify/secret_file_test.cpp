// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/secret_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "capture/notify/notifier.h"
#include "tests/support/temp_folder.h"

namespace patina::capture::notify {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class SecretFile : public ::testing::Test {
 protected:
  std::filesystem::path plant(const std::string& text, mode_t mode = 0600) {
    patina::testing::writeFile(folder_ / "secret", text);
    chmod((folder_ / "secret").c_str(), mode);
    return folder_ / "secret";
  }
  static std::string problem(const std::filesystem::path& file) {
    try {
      readSecret(file);
    } catch (const NotifyError& error) {
      return error.what();
    }
    return "no error";
  }
  patina::testing::TempFolder folder_ = patina::testing::TempFolder::inMemory();
};

TEST_F(SecretFile, IsReadWithoutItsEndOfLine) {
  EXPECT_EQ(readSecret(plant("hunter2\n")), "hunter2");
  EXPECT_EQ(readSecret(plant("hunter2\r\n", 0640)), "hunter2");
}

TEST_F(SecretFile, IsRefusedWhenEverybodyMayReadIt) {
  EXPECT_THAT(problem(plant("hunter2", 0644)), HasSubstr("chmod o="));
}

TEST_F(SecretFile, IsRefusedWhenItIsNoSingleLineAndNeverRepeated) {
  for (const std::string& text :
       {std::string("hunter2\nX: y"), std::string("hunter2\r\nX: y\n"), std::string(""),
        std::string("hunter2\0x", 9), std::string(5000, 'h')}) {
    EXPECT_THAT(problem(plant(text)), HasSubstr("one line"));
    EXPECT_THAT(problem(plant(text)), Not(HasSubstr("hunter2")));
  }
}

TEST_F(SecretFile, IsRefusedWhenItIsNoFileAndNamedWhenItIsNotThere) {
  EXPECT_THAT(problem(folder_.path()), HasSubstr("no regular file"));
  const auto pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(problem(pipe), HasSubstr("no regular file"));
  EXPECT_THAT(problem(folder_ / "none"), HasSubstr("none cannot be read"));
}

}  // namespace
}  // namespace patina::capture::notify
