// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/backup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "db/frame_store.h"
#include "db/journal.h"
#include "tests/db/dump.h"
#include "tests/db/hooked_disk.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::care {
namespace {

namespace fs = std::filesystem;
using namespace db::testing;
using patina::testing::readFile;
using patina::testing::TempFolder;
using patina::testing::writeFile;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kFrames = 6;

class BackupTest : public ::testing::Test {
 protected:
  BackupTest() {
    open();
    beginRun(*archive_);
    for (int number = 0; number < kFrames; ++number) shoot(number);
    const fs::path film = ProductWriter::folderFor(path_, "film-1") / "film.mp4";
    writeFile(film, "a film");
    ProductRow product;
    product.id = "film-1";
    product.kind = "film";
    product.path = "film.mp4";
    product.sha256 = sha256OfFile(film).hex();
    ProductWriter::add(path_, product);
  }
  void open() { archive_ = std::make_unique<Archive>(optionsFor(path_)); }
  void shoot(int number) { capture(*archive_, number, static_cast<std::uint64_t>(number)); }
  BackupReport backUp(const BackupOptions& options = {}) {
    return backup(path_, to_, options, progress_);
  }
  fs::path frame(std::uint64_t seed, const fs::path& archive) const {
    return archive / framePath(sha256(frameBytes(seed)), "jpg");
  }
  void expectWhole(const fs::path& archive) {
    for (const auto& p : verify(archive, progress_).problems)
      ADD_FAILURE() << p.what << " " << p.path << " " << p.detail;
  }
  TempFolder folder_ = TempFolder::inMemory();
  fs::path path_ = folder_ / "archive", to_ = folder_ / "backup";
  Progress progress_;
  std::unique_ptr<Archive> archive_;  // the capturing process
};

TEST_F(BackupTest, HoldsTheSameRowsAndFramesBesideACapturingProcess) {
  const BackupReport report = backUp();
  EXPECT_EQ(report.frames_copied, kFrames);
  EXPECT_EQ(report.products_copied, 1);
  EXPECT_THAT(report.problems, IsEmpty());
  expectWhole(to_);
  archive_.reset();
  EXPECT_EQ(dumpOf(to_), dumpOf(path_));
  EXPECT_EQ(readFile(to_ / "products" / "film-1" / "film.mp4"), "a film");
}

TEST_F(BackupTest, CopiesOnlyWhatIsNotThereYet) {
  backUp();
  shoot(kFrames);
  const BackupReport report = backUp();
  EXPECT_EQ(report.frames, kFrames + 1);
  EXPECT_EQ(report.frames_copied, 1);
  EXPECT_EQ(report.products_copied, 0);
  expectWhole(to_);
}

TEST_F(BackupTest, HoldsWhatWasSetAsideOnce) {
  archive_->quarantine(frameBytes(99), "jpg", {0, {}, {}, "quarantine", "a picture of nothing"});
  const fs::path set_aside = to_ / "quarantine" / (sha256(frameBytes(99)).hex() + ".jpg");
  EXPECT_EQ(backUp().set_aside_copied, 1);
  EXPECT_EQ(sha256OfFile(set_aside), sha256(frameBytes(99)));
  EXPECT_EQ(backUp().set_aside_copied, 0);
  expectWhole(to_);
}

TEST_F(BackupTest, IsAnArchiveThatGoesOn) {
  backUp();
  Archive restored(optionsFor(to_));
  EXPECT_EQ(restored.recovery().rows_from_journal, 0) << "journals and catalogue agree";
  EXPECT_EQ(restored.runState(kRunId)->last_number, kFrames - 1);
  capture(restored, kFrames, 99);
  expectWhole(to_);
}

TEST_F(BackupTest, TakesACatalogueAtOneMomentOfARunThatGoesOn) {
  // A frame is committed in the middle of the backup: after the snapshot, before the frames.
  int copied = 0;
  HookedDisk disk([&](Call call, const fs::path& path) {
    if (call == Call::kRename && path.string().find("frames") != std::string::npos && copied++ == 2)
      shoot(kFrames);
    return 0;
  });
  BackupOptions options;
  options.files = &disk;
  const BackupReport report = backUp(options);
  EXPECT_EQ(report.frames, kFrames);
  expectWhole(to_);
  EXPECT_FALSE(fs::exists(frame(kFrames, to_)));
  EXPECT_EQ(backUp().frames_copied, 1);
}

TEST_F(BackupTest, WhereverItIsKilledTheLastWholeBackupStaysAndTheNextOneIsWhole) {
  backUp();
  archive_.reset();
  const auto first = dumpOf(to_);
  open();
  for (int number = kFrames; number < kFrames + 3; ++number) shoot(number);
  archive_.reset();  // no open database across a fork
  for (int k = 0;; k += 3) {
    const fs::path copy = folder_ / ("copy-" + std::to_string(k));
    fs::copy(to_, copy, fs::copy_options::recursive);
    const pid_t child = ::fork();
    if (child == 0) {
      int calls = 0;
      HookedDisk disk([&](Call, const fs::path&) {
        if (calls++ == k) ::_exit(9);
        return 0;
      });
      BackupOptions options;
      options.files = &disk;
      backup(path_, copy, options, progress_);
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    const bool finished = WEXITSTATUS(status) == 0;
    { const Archive opened(optionsFor(copy)); }  // restores from it, whatever came of it
    EXPECT_EQ(verify(copy, progress_).problems.size(), 0u) << "killed at call " << k;
    backup(path_, copy, {}, progress_);
    EXPECT_EQ(ArchiveReader(copy).steps(kRunId).size(), static_cast<std::size_t>(kFrames + 3)) << k;
    expectWhole(copy);
    fs::remove_all(copy);
    if (finished) break;
    ASSERT_LT(k, 1000);
  }
}

TEST_F(BackupTest, AFirstBackupThatWasKilledIsNoArchiveYetAndGoesOn) {
  archive_.reset();  // no open database across a fork
  const pid_t child = ::fork();
  if (child == 0) {
    int placed = 0;
    HookedDisk disk([&](Call call, const fs::path& path) {
      if (call == Call::kRename && path.string().find("/frames/") != std::string::npos &&
          ++placed == 4)
        ::_exit(9);
      return 0;
    });
    BackupOptions options;
    options.files = &disk;
    backup(path_, to_, options, progress_);
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
  EXPECT_THROW(ArchiveReader reader(to_), ArchiveError);
  EXPECT_EQ(backUp().frames_copied, kFrames - 3);
  expectWhole(to_);
}

TEST_F(BackupTest, ADamagedFrameIsNamedAndNotCopied) {
  writeFile(frame(2, path_), readFile(frame(2, path_)).replace(100, 1, "?"));
  fs::remove(frame(3, path_));
  const BackupReport report = backUp();
  ASSERT_EQ(report.problems.size(), 2u);
  EXPECT_EQ(report.frames_copied, kFrames - 2);
  EXPECT_FALSE(fs::exists(frame(2, to_)));
}

TEST_F(BackupTest, WhatTheArchiveLostTheBackupKeeps) {
  backUp();
  fs::remove(frame(3, path_));
  const BackupReport report = backUp();
  ASSERT_EQ(report.problems.size(), 1u);
  EXPECT_THAT(report.problems[0].detail, HasSubstr("the backup has it"));
  EXPECT_TRUE(fs::exists(frame(3, to_)));
}

TEST_F(BackupTest, CheckReplacesWhatTheBackupsDiskDamaged) {
  backUp();
  const std::string whole = readFile(frame(1, to_));
  writeFile(frame(1, to_), std::string(whole).replace(5, 1, "?"));
  EXPECT_EQ(backUp().frames_copied, 0) << "sizes alone do not tell";
  BackupOptions options;
  options.check = true;
  EXPECT_EQ(backUp(options).frames_copied, 1);
  EXPECT_EQ(readFile(frame(1, to_)), whole);
}

TEST_F(BackupTest, ADamagedJournalIsWrittenFromTheCatalogue) {
  const auto journal = journalPath(path_, kRunId);
  std::string text = readFile(journal);
  text[text.size() / 2] = static_cast<char>(text[text.size() / 2] ^ 1);
  writeFile(journal, text);
  const BackupReport report = backUp();
  ASSERT_EQ(report.problems.size(), 1u);
  EXPECT_EQ(report.problems[0].what, "journal");
  expectWhole(to_);
}

TEST_F(BackupTest, RefusesAnotherArchivesBackupAndLeavesItAsItWas) {
  const fs::path other = folder_ / "other";
  {
    Archive archive(optionsFor(other));
    beginRun(archive);
    capture(archive, 0, 1000);
  }
  const auto before = dumpOf(other);
  try {
    backup(path_, other, {}, progress_);
    FAIL() << "overwrote another archive";
  } catch (const ArchiveError& e) {
    EXPECT_EQ(e.exit(), Exit::kUsage);
    EXPECT_THAT(e.what(), HasSubstr("does not know"));
  }
  EXPECT_EQ(dumpOf(other), before);
}

TEST_F(BackupTest, RefusesFoldersThatAreNoPlaceForIt) {
  EXPECT_THROW(backup(path_, path_, {}, progress_), ArchiveError);
  EXPECT_THROW(backup(path_, path_ / "backup", {}, progress_), ArchiveError);
  EXPECT_THROW(backup(path_, folder_.path(), {}, progress_), ArchiveError);
  EXPECT_THROW(backup(folder_ / "nothing", to_, {}, progress_), ArchiveError);
  EXPECT_FALSE(fs::exists(to_));
  fs::create_directory(to_);
  writeFile(to_ / "letter.txt", "dear");
  EXPECT_THROW(backUp(), ArchiveError);
  EXPECT_EQ(std::distance(fs::directory_iterator(to_), {}), 1);
}

TEST_F(BackupTest, SaysWhatIsMissingBeforeItFillsADisk) {
  class SmallDisk final : public FileOps {
   public:
    int open(const fs::path& p, Mode m, std::unique_ptr<File>* out) override {
      return real_.open(p, m, out);
    }
    int renameNoReplace(const fs::path& a, const fs::path& b) override {
      return real_.renameNoReplace(a, b);
    }
    int renameReplace(const fs::path& a, const fs::path& b) override {
      return real_.renameReplace(a, b);
    }
    int syncFolder(const fs::path& f) override { return real_.syncFolder(f); }
    int makeFolder(const fs::path& f) override { return real_.makeFolder(f); }
    int remove(const fs::path& p) override { return real_.remove(p); }
    int space(const fs::path&, Space* out) override {
      *out = {10'000, 10'000};
      return 0;
    }
    int lock(const fs::path& p, std::unique_ptr<FileLock>* out) override {
      return real_.lock(p, out);
    }
    int isNetwork(const fs::path& f) override { return real_.isNetwork(f); }
    std::unique_ptr<File> adopt(const fs::path& p, std::unique_ptr<File> file) override {
      return real_.adopt(p, std::move(file));
    }

   private:
    FileOps& real_ = realFileOps();
  } disk;
  BackupOptions options;
  options.files = &disk;
  EXPECT_THROW(backUp(options), DiskFull);
  EXPECT_FALSE(fs::exists(frame(0, to_)));
}

TEST_F(BackupTest, StopsWhenAskedAndGoesOn) {
  progress_.askToStop();
  EXPECT_THROW(backUp(), Stopped);
  Progress fresh;
  EXPECT_EQ(backup(path_, to_, {}, fresh).frames_copied, kFrames);
}

}  // namespace
}  // namespace patina::db::care
