// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "db/archive.h"
#include "db/frame_store.h"
#include "db/journal.h"
#include "tests/db/dump.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

namespace fs = std::filesystem;
using patina::testing::readFile;
using patina::testing::TempFolder;
using patina::testing::writeFile;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kFrames = 5;

class AdoptFiles : public ::testing::Test {
 protected:
  AdoptFiles() {
    {
      Archive archive(optionsFor(path_));
      beginRun(archive);
      for (int number = 0; number < kFrames; ++number) {
        capture(archive, number, static_cast<std::uint64_t>(number));
        hashes_.push_back(archive.reader().newestFrame(kRunId)->sha256);
      }
    }
    const fs::path film = ProductWriter::folderFor(path_, "film-1") / "film.mp4";
    writeFile(film, "a film");
    ProductRow product;
    product.id = "film-1";
    product.kind = "film";
    product.path = "film.mp4";
    product.sha256 = sha256OfFile(film).hex();
    ProductWriter::add(path_, product);
  }
  void loseCatalogue() { fs::remove(path_ / "catalog.sqlite"); }
  void loseJournals() {
    for (const auto& name : journalNames(path_)) fs::remove(journalPath(path_, name));
  }
  std::vector<Sha256> hashesOf(const std::string& run_id) {
    std::vector<Sha256> hashes;
    ArchiveReader(path_).eachFrame(
        run_id, [&](const auto& captured) { hashes.push_back(captured.frame.sha256); });
    return hashes;
  }
  void expectWhole() {
    for (const auto& p : verify(path_, progress_).problems)
      ADD_FAILURE() << p.what << " " << p.path << " " << p.detail;
  }
  TempFolder folder_ = TempFolder::inMemory();
  fs::path path_ = folder_ / "archive";
  std::vector<Sha256> hashes_;
  Progress progress_;
};

TEST_F(AdoptFiles, WithNeitherCatalogueNorJournalEveryWholeFrameIsKept) {
  loseCatalogue();
  loseJournals();
  const RecoveryReport report = rebuild(path_, progress_);
  EXPECT_EQ(report.frames_from_files, kFrames);
  EXPECT_EQ(report.frames_dated_by_file, kFrames) << "noise has no EXIF";
  EXPECT_EQ(report.products_from_files, 1);
  EXPECT_EQ(report.frames_quarantined, 0);
  EXPECT_THAT(hashesOf(report.recovered_run), ::testing::UnorderedElementsAreArray(hashes_));
  const ArchiveReader reader(path_);
  EXPECT_EQ(reader.findRun("latest").state, "recovered");
  EXPECT_EQ(reader.products()[0].path, "film.mp4");
  EXPECT_EQ(reader.steps(report.recovered_run).size(), static_cast<std::size_t>(kFrames));
  expectWhole();
}

TEST_F(AdoptFiles, WhatWasAdoptedIsJournalledToo) {
  loseCatalogue();
  loseJournals();
  rebuild(path_, progress_);
  const auto before = dumpOf(path_);
  loseCatalogue();
  EXPECT_EQ(rebuild(path_, progress_).frames_from_files, 0);
  EXPECT_EQ(dumpOf(path_), before);
}

TEST_F(AdoptFiles, AStartDoesNotMakeStrangersOfFramesThatNothingTellsOf) {
  loseCatalogue();
  loseJournals();
  try {
    const Archive archive(optionsFor(path_));
    FAIL() << "began an empty catalogue over " << kFrames << " frames";
  } catch (const ArchiveError& e) {
    EXPECT_EQ(e.exit(), Exit::kBadData);
    EXPECT_THAT(e.what(), HasSubstr("archive rebuild"));
  }
  EXPECT_EQ(rebuild(path_, progress_).frames_from_files, kFrames);
}

TEST_F(AdoptFiles, ATruncatedJournalWithoutACatalogueKeepsTheFramesOfItsLostTail) {
  loseCatalogue();
  const auto journal = journalPath(path_, kRunId);
  fs::resize_file(journal, fs::file_size(journal) / 2);
  const RecoveryReport report = rebuild(path_, progress_);
  const auto kept = hashesOf(kRunId), recovered = hashesOf(report.recovered_run);
  EXPECT_GT(kept.size(), 0u);
  EXPECT_GT(recovered.size(), 0u);
  EXPECT_EQ(kept.size() + recovered.size(), static_cast<std::size_t>(kFrames));
  expectWhole();
}

TEST_F(AdoptFiles, FlippedBitsAnywhereInAJournalWithoutACatalogueLoseNoFrame) {
  const auto journal = journalPath(path_, kRunId);
  const std::string whole = readFile(journal);
  for (std::size_t at = 11; at < whole.size(); at += whole.size() / 13) {
    const TempFolder again = TempFolder::inMemory();
    const fs::path copy = again / "archive";
    fs::copy(path_, copy, fs::copy_options::recursive);
    fs::remove(copy / "catalog.sqlite");
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    writeFile(journalPath(copy, kRunId), damaged);
    rebuild(copy, progress_);
    std::int64_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(copy / "frames"))
      files += entry.is_regular_file() ? 1 : 0;
    EXPECT_EQ(files, kFrames) << "flipped at " << at;
    for (const auto& p : verify(copy, progress_).problems)
      ADD_FAILURE() << at << ": " << p.what << " " << p.path << " " << p.detail;
  }
}

TEST_F(AdoptFiles, ADamagedFrameIsNoFrame) {
  loseCatalogue();
  loseJournals();
  writeFile(path_ / framePath(hashes_[2], "jpg"), "not what it was");
  const RecoveryReport report = rebuild(path_, progress_);
  EXPECT_EQ(report.frames_from_files, kFrames - 1);
  EXPECT_EQ(report.frames_quarantined, 1);
  expectWhole();
}

TEST_F(AdoptFiles, ACatalogueThatCanBeReadVouchesForTheJournals) {
  const Bytes bytes = frameBytes(99);
  const fs::path stray = path_ / framePath(sha256(bytes), "jpg");
  fs::create_directories(stray.parent_path());
  writeFile(stray, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const RecoveryReport report = rebuild(path_, progress_);
  EXPECT_EQ(report.frames_from_files, 0);
  EXPECT_EQ(report.frames_quarantined, 1) << "it was never acknowledged";
}

TEST_F(AdoptFiles, FramesOnlySetsCatalogueAndJournalsAside) {
  const auto before = dumpOf(path_);
  const RecoveryReport report = rebuildFromFrames(path_, progress_);
  EXPECT_EQ(report.frames_from_files, kFrames);
  EXPECT_EQ(ArchiveReader(path_).runs().size(), 1u);
  expectWhole();
  const fs::path aside = path_ / "care" / "before-rebuild-1";
  EXPECT_TRUE(fs::exists(aside / "journal" / (kRunId + ".jsonl")));
  EXPECT_EQ(dumpOf(aside), before) << "nothing of it is lost";
}

}  // namespace
}  // namespace patina::db::testing
