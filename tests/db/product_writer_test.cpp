// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "db/archive.h"
#include "db/journal.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::readFile;
using patina::testing::TempFolder;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

ProductRow ttf(const std::string& id) {
  ProductRow product;
  product.id = id;
  product.kind = "ttf";
  product.path = "products/" + id + "/" + id + ".h5";
  product.seed = 0xffffffffffffffff;
  product.input_sha256s = {"aa", "bb"};
  return product;
}

class ProductWriterTest : public ::testing::Test {
 protected:
  TempFolder folder_ = TempFolder::inMemory();
  std::filesystem::path path_ = folder_ / "archive";
  Progress progress_;
};

TEST_F(ProductWriterTest, AddsBesideACapturingOwnerAndBothGoOn) {
  Archive archive(optionsFor(path_));
  beginRun(archive);
  for (int number = 0; number < 5; ++number) {
    capture(archive, number, static_cast<std::uint64_t>(number));
    ProductWriter::add(path_, ttf("ttf-" + std::to_string(number)));
    archive.addDevice({"lamp" + std::to_string(number), "light", "twin", "", ""});
  }
  const auto products = archive.reader().products("ttf");
  ASSERT_THAT(products, SizeIs(5));
  EXPECT_EQ(products[0].seed, 0xffffffffffffffff);
  EXPECT_THAT(products[0].input_sha256s, ElementsAre("aa", "bb"));
  EXPECT_THAT(archive.reader().products("film"), IsEmpty());
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ProductWriterTest, AProductMadeAgainReplacesItsInputs) {
  { Archive archive(optionsFor(path_)); }
  ProductWriter::add(path_, ttf("ttf-1"));
  ProductRow again = ttf("ttf-1");
  again.input_sha256s = {"cc"};
  ProductWriter::add(path_, again);
  EXPECT_THAT(ArchiveReader(path_).products().at(0).input_sha256s, ElementsAre("cc"));
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ProductWriterTest, TakesOverWhatADeadWriterLeftInTheJournal) {
  { Archive archive(optionsFor(path_)); }
  ProductWriter::add(path_, ttf("ttf-1"));
  const auto catalogue = path_ / "catalog.sqlite";
  std::filesystem::copy_file(catalogue, folder_ / "older.sqlite");
  ProductWriter::add(path_, ttf("ttf-2"));
  // Died between its journal line and its COMMIT, and the next one in mid line.
  std::filesystem::copy_file(folder_ / "older.sqlite", catalogue,
                             std::filesystem::copy_options::overwrite_existing);
  const auto journal = journalPath(path_, kSharedJournal);
  patina::testing::writeFile(journal, readFile(journal) + "{\"row\":\"pro");
  ProductWriter::add(path_, ttf("ttf-3"));
  EXPECT_THAT(ArchiveReader(path_).products(), SizeIs(3));
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ProductWriterTest, BindsCalibrationsToFrames) {
  RowId frame = 0;
  {
    Archive archive(optionsFor(path_));
    beginRun(archive);
    frame = capture(archive, 0, 1)[0].id;
  }
  CalibrationRow dark;
  dark.kind = "dark";
  dark.size = {64, 48};
  const RowId id = ProductWriter::addCalibration(path_, dark);
  ProductWriter::bind(path_, std::vector{FrameCalibrationRow{frame, id, 3600, 0.5, false}});
  const auto calibrations = ArchiveReader(path_).calibrations("dark");
  ASSERT_THAT(calibrations, SizeIs(1));
  EXPECT_EQ(calibrations[0].size, (SizePx{64, 48}));
  EXPECT_THROW(ProductWriter::bind(path_, std::vector{FrameCalibrationRow{frame + 9, id}}),
               ArchiveError)
      << "no such frame";
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ProductWriterTest, AnIdNamesAFolderAndNothingElse) {
  EXPECT_EQ(ProductWriter::folderFor(path_, "ttf-1"), path_ / "products" / "ttf-1");
  EXPECT_TRUE(std::filesystem::is_directory(path_ / "products" / "ttf-1"));
  for (const char* bad : {"", "..", "a/b"})
    EXPECT_THROW(ProductWriter::folderFor(path_, bad), ArchiveError);
}

}  // namespace
}  // namespace patina::db::testing
