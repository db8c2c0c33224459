// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/export_frames.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "processing/image/sidecar_file.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::MadeShot;
using testing::TempFolder;
using ::testing::UnorderedElementsAre;

class ExportFrames : public ::testing::Test {
 protected:
  ExportFrames() {
    MadeShot rim;
    rim.light = "key+rim";
    rim.level = 90;
    MadeShot again;
    again.level = 80;
    run_ = testing::makeRun(archive_, {{{MadeShot{}, rim}}, {{again}}});
  }
  ExportReport go(bool link = false) {
    const db::ArchiveReader reader(archive_);
    return exportFrames(reader, run_, out_, {link}, progress_);
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(out_)) names.push_back(entry.path().filename());
    return names;
  }
  std::string pathOfFirst() {
    const db::ArchiveReader reader(archive_);
    return reader.pathOf(
        reader.framesBetween(run_, testing::kMay, testing::kMay + std::chrono::seconds(1))[0]);
  }
  TempFolder folder_ = TempFolder::inMemory();
  fs::path archive_ = folder_ / "archive", out_ = folder_ / "out";
  std::string run_;
  Progress progress_;
};

TEST_F(ExportFrames, NamesEachByTimeStepCameraAndLight) {
  EXPECT_EQ(go().written, 3);
  EXPECT_THAT(files(), UnorderedElementsAre("20240501T000000.000Z_000000_cam0_key_e0.png",
                                            "20240501T000000.000Z_000000_cam0_key+rim_e0.png",
                                            "20240501T001000.000Z_000001_cam0_key_e0.png",
                                            "manifest.csv", "SHA256SUMS"));
  const std::string manifest = testing::readFile(out_ / "manifest.csv");
  EXPECT_THAT(manifest, HasSubstr(",0,captured,cam0,key+rim,0,20000000,100,"));
  EXPECT_EQ(std::count(manifest.begin(), manifest.end(), '\n'), 4);
}

TEST_F(ExportFrames, TheSumsAreThoseOfCoreutils) {
  go();
  const std::string check = "cd '" + out_.string() + "' && sha256sum --quiet -c SHA256SUMS";
  EXPECT_EQ(std::system(check.c_str()), 0);
}

TEST_F(ExportFrames, AgainWritesOnlyWhatIsMissing) {
  go();
  fs::remove(out_ / "20240501T001000.000Z_000001_cam0_key_e0.png");
  fs::remove(out_ / "manifest.csv");
  testing::writeFile(out_ / "UNFINISHED", run_);  // as a death leaves it
  const ExportReport report = go();
  EXPECT_EQ(report.written, 1);
  EXPECT_EQ(report.frames, 3);
  EXPECT_EQ(files().size(), 5u);
}

TEST_F(ExportFrames, FilesAreReadOnlyCopies) {
  go();
  const auto mode = fs::status(out_ / "20240501T001000.000Z_000001_cam0_key_e0.png").permissions();
  EXPECT_EQ(mode & (fs::perms::owner_write | fs::perms::group_write), fs::perms::none);
}

TEST_F(ExportFrames, LinksShareTheArchivesFilesAndProtectThem) {
  const ExportReport report = go(true);
  EXPECT_EQ(report.linked, 3);
  EXPECT_EQ(report.written, 0);
  EXPECT_EQ(fs::hard_link_count(pathOfFirst()), 2u);
  EXPECT_EQ(fs::status(pathOfFirst()).permissions() & fs::perms::owner_write, fs::perms::none);
}

TEST_F(ExportFrames, SidecarsSayWhatTheRowsKnow) {
  const db::ArchiveReader reader(archive_);
  exportFrames(reader, run_, out_, {.sidecars = true}, progress_);
  const fs::path picture = out_ / "20240501T001000.000Z_000001_cam0_key_e0.png";
  const PictureMetadata said = readMetadataOf(picture, readFile(picture));
  EXPECT_EQ(said.exposure, std::chrono::milliseconds(20));
  EXPECT_EQ(said.iso, Iso{100});
  EXPECT_EQ(said.camera, "cam0");
  EXPECT_EQ(said.taken_utc, testing::kMay + std::chrono::minutes(10));
}

TEST_F(ExportFrames, ADamagedFrameIsNamedAndLeftOut) {
  const std::string path = pathOfFirst();
  testing::writeFile(path, testing::readFile(path) + "x");
  const ExportReport report = go();
  ASSERT_EQ(report.problems.size(), 1u);
  EXPECT_THAT(report.problems[0], HasSubstr(fs::path(path).filename().string()));
  EXPECT_EQ(report.frames, 2);
}

TEST_F(ExportFrames, RefusesAFolderOfSomethingElse) {
  fs::create_directories(out_);
  testing::writeFile(out_ / "letter.txt", "dear");
  EXPECT_THROW(go(), WorkflowError);
  EXPECT_EQ(files().size(), 1u);
  fs::remove(out_ / "letter.txt");
  testing::writeFile(out_ / "UNFINISHED", "another-run");
  EXPECT_THROW(go(), WorkflowError);
}

TEST_F(ExportFrames, StopsWhenAskedAndGoesOn) {
  Progress stopped;
  stopped.askToStop();
  const db::ArchiveReader reader(archive_);
  EXPECT_THROW(exportFrames(reader, run_, out_, {}, stopped), Stopped);
  EXPECT_FALSE(fs::exists(out_ / "manifest.csv"));
  EXPECT_EQ(go().frames, 3);
  EXPECT_FALSE(fs::exists(out_ / "UNFINISHED"));
}

}  // namespace
}  // namespace patina::workflow
