// SPDX-License-Identifier: GPL-3.0-or-later
// Real file systems that cannot do what an archive asks of them, or stop doing so in mid run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <system_error>

#include "tests/capture/app/ack_pipe.h"
#include "tests/capture/app/rehearsed.h"
#include "tests/system/mounted.h"
#include "tests/system/no_lock_fs.h"

namespace patina::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class FileSystems : public ::testing::Test {
 protected:
  FileSystems() { fs::create_directory(place_); }

  Finished patina(std::vector<std::string> arguments, const fs::path& archive) {
    arguments.insert(arguments.end(), {"--archive", archive});
    return runPatina(std::move(arguments));
  }
  Finished rehearse(const fs::path& archive) {
    return patina({"rehearse", changedPlan(files_, {{"[\"ttf\", \"film\"]", "[]"}})}, archive);
  }
  // In real time, ten shots a second.
  std::string quickPlan() {
    return changedPlan(files_,
                       {{"[\"ttf\", \"film\"]", "[]"},
                        {"interval = \"10min\"", "interval = \"100ms\""},
                        {"duration = \"2h\"", "duration = \"30min\"\n[disk]\nreserve = \"4MB\""}});
  }
  // Every frame that was acknowledged is there, and all else is in order.
  void expectKept(const fs::path& archive, const std::vector<std::string>& acks) {
    const Finished verified = patina({"archive", "verify"}, archive);
    EXPECT_EQ(verified.exit, 0) << verified.out << verified.err;
    for (const std::string& ack : acks) {
      std::istringstream words(ack);
      std::string word, run, shot, index, sha256;
      words >> word >> run >> shot >> index >> sha256;
      bool found = false;
      for (const auto& entry : fs::directory_iterator(archive / "frames" / sha256.substr(0, 2)))
        found |= entry.path().stem() == sha256.substr(2);
      EXPECT_TRUE(found) << ack;
    }
  }
  TempFolder folder_, files_ = TempFolder::inMemory();
  fs::path place_ = folder_ / "mount";
};

TEST_F(FileSystems, AReadOnlyMountIsReadAndSaysThatItCannotBeWritten) {
  const Mounted disk = Mounted::tmpfs(place_, "512m");
  PATINA_MOUNT_OR_SKIP(disk);
  const fs::path archive = place_ / "archive";
  ASSERT_EQ(rehearse(archive).exit, 0);
  ASSERT_TRUE(disk.makeReadOnly());

  EXPECT_EQ(patina({"archive", "list"}, archive).exit, 0);
  EXPECT_EQ(patina({"archive", "verify"}, archive).exit, 0);
  const Finished scrubbed = patina({"archive", "scrub"}, archive);
  EXPECT_EQ(scrubbed.exit, 0) << scrubbed.err;
  EXPECT_THAT(scrubbed.err, HasSubstr("begins here again"));
  EXPECT_EQ(patina({"archive", "gc", "--dry-run"}, archive).exit, 0);
  EXPECT_EQ(patina({"archive", "gc"}, archive).exit, 73);
  EXPECT_EQ(patina({"archive", "rebuild"}, archive).exit, 73);
  const Finished saved = patina({"archive", "backup", folder_ / "backup"}, archive);
  EXPECT_EQ(saved.exit, 0) << saved.err;
  EXPECT_EQ(patina({"archive", "verify"}, folder_ / "backup").exit, 0);

  const Finished refused = rehearse(archive);
  EXPECT_EQ(refused.exit, 73);
  EXPECT_THAT(refused.err, HasSubstr("read-only"));
  const Finished examined = patina({"doctor"}, archive);
  EXPECT_EQ(examined.exit, 78);
  EXPECT_THAT(examined.out, HasSubstr("mounted read-only"));
}

TEST_F(FileSystems, ADiskThatFillsUpInMidRunStopsCapturesAndTheyGoOnWhenThereIsRoom) {
  const Mounted disk = Mounted::tmpfs(place_, "32m");
  PATINA_MOUNT_OR_SKIP(disk);
  const fs::path archive = place_ / "archive", filler = place_ / "filler";
  AckPipe pipe(files_ / "acks");
  Child child({program(), "capture", quickPlan(), "--archive", archive, "--log-acks", pipe.path()});
  std::vector<std::string> acks = {pipe.line()};
  {
    // Not a byte left, not even of the reserve that the plan asks for.
    std::ofstream file(filler, std::ios::binary);
    const std::string piece(4096, 'f');
    while (file.write(piece.data(), 4096).flush()) {
    }
  }
  const auto told = [&] {
    return patina({"archive", "show", "latest"}, archive).out.find("no new captures") !=
           std::string::npos;
  };
  int asked = 0;
  while (!told()) ASSERT_LT(++asked, 500) << "the disk is full, and nobody noticed";
  fs::remove(filler);
  // Lines of shots from before it was full may wait in the pipe; the last one is of a later shot.
  const auto captured = [&] {
    const JsonAnswer list = answerOf(patina({"archive", "list", "--json"}, archive));
    return list.number("/items/0/captured");
  };
  const double before = captured();
  asked = 0;
  while (captured() <= before) ASSERT_LT(++asked, 500) << "there is room, and nobody noticed";
  child.signal(SIGTERM);
  const Finished finished = child.wait();
  EXPECT_EQ(finished.exit, 0) << finished.err;
  for (int k = 1; k < static_cast<int>(before); ++k) acks.push_back(pipe.line());
  expectKept(archive, acks);
  EXPECT_TRUE(fs::exists(archive / "reserve"));
  EXPECT_THAT(patina({"archive", "show", "latest"}, archive).out, HasSubstr("room again"));
}

TEST_F(FileSystems, ADiskThatIsTooSmallFromTheStartIsRefusedAndLeftWhole) {
  const Mounted disk = Mounted::tmpfs(place_, "256k");
  PATINA_MOUNT_OR_SKIP(disk);
  const Finished refused = rehearse(place_ / "archive");
  EXPECT_EQ(refused.exit, 73) << refused.out << refused.err;
  EXPECT_THAT(refused.err, ::testing::AnyOf(HasSubstr("No space left"), HasSubstr("full")));
}

TEST_F(FileSystems, ADiskThatIsUnmountedInMidRunIsAnIoErrorAndLosesNothing) {
  fs::create_directory(folder_ / "disk");
  const Mounted disk = Mounted::bind(folder_ / "disk", place_);
  PATINA_MOUNT_OR_SKIP(disk);
  AckPipe pipe(files_ / "acks");
  const std::string plan = quickPlan();
  std::vector<std::string> acks;
  {
    Child child(
        {program(), "capture", plan, "--archive", place_ / "archive", "--log-acks", pipe.path()});
    for (int k = 0; k < 3; ++k) acks.push_back(pipe.line());
    disk.detach();
    const Finished finished = child.wait();
    EXPECT_EQ(finished.exit, 74) << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("unmounted"));
  }
  EXPECT_TRUE(fs::is_empty(place_)) << "nothing is written to the empty mount point";
  const fs::path archive = folder_ / "disk" / "archive";
  Child again(
      {program(), "capture", plan, "--archive", archive, "--json", "--log-acks", pipe.path()});
  acks.push_back(pipe.line());
  again.signal(SIGTERM);
  EXPECT_EQ(again.wait().exit, 0);
  expectKept(archive, acks);
  EXPECT_EQ(answerOf(patina({"archive", "list", "--json"}, archive)).size("/items"), 1u)
      << "the same run went on";
}

TEST_F(FileSystems, OneWithoutLocksIsRefused) {
  try {
    const NoLockFileSystem served(place_);
    const Finished refused = rehearse(place_ / "archive");
    EXPECT_EQ(refused.exit, 73) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr("has no locks"));
  } catch (const std::system_error& e) {
    GTEST_SKIP() << "cannot serve a file system here: " << e.what();
  }
}

}  // namespace
}  // namespace patina::testing
