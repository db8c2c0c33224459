// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/master_pictures.h"

#include <gtest/gtest.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/twin_files.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

TEST(PictureStackOf, RawFilesIsAMosaicWithWhatTheySay) {
  const TempFolder folder = TempFolder::inMemory();
  testing::TwinFiles files;
  files.plant(folder / "f", {1, 1, 1});
  std::vector<std::string> notes;
  const PictureStack stack = stackOfFolder(folder / "f", testing::now(), notes);
  EXPECT_EQ(stack.channels, 1);
  EXPECT_EQ(stack.key.bits, 12);
  EXPECT_EQ(stack.key.exposure, std::chrono::milliseconds(20));
  EXPECT_EQ(stack.key.iso, 100);
  EXPECT_EQ(stack.filters, (calibration::ColourFilters{0, 1, 1, 2}));
  const auto next = stack.open(nullptr)();
  for (int i = 0; i < 3; ++i) {
    const std::optional<Image<float>> frame = next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->channels(), 1);
    EXPECT_NEAR(frame->at(64, 48), 0.45, 0.05);
  }
  EXPECT_FALSE(next());
}

TEST(PictureStackOf, AnEmptyFolderIsRefused) {
  const TempFolder folder = TempFolder::inMemory();
  std::vector<std::string> notes;
  EXPECT_THROW((void)stackOfFolder(folder.path(), testing::now(), notes), WorkflowError);
}

}  // namespace
}  // namespace patina::workflow
