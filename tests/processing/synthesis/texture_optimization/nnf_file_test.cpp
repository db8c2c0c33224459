// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/nnf_file.h"

#include <gmock/gmock.h>

#include <cstring>

#include "tests/support/temp_folder.h"

namespace patina::texture_optimization {
namespace {

TEST(NnfFile, IsAnArrayThatNumpyReads) {
  const testing::TempFolder temp = testing::TempFolder::inMemory();
  OptimizedField field;
  field.size = {3, 2};
  field.centres = {12, 13, 14, 22, 23, 25};
  writeNnf(temp / "nnf.npy", field, 10);
  const std::string bytes = testing::readFile(temp / "nnf.npy");
  ASSERT_EQ(bytes.size() % 8, 0u);
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t start = 10 + static_cast<unsigned char>(bytes[8]);
  EXPECT_EQ(start % 64, 0u);
  EXPECT_THAT(bytes, ::testing::HasSubstr("'shape': (2, 3, 2)"));
  EXPECT_EQ(bytes[start - 1], '\n');
  ASSERT_EQ(bytes.size(), start + 48);
  std::int32_t last[2];
  std::memcpy(last, &bytes[start + 40], sizeof last);
  EXPECT_EQ(last[0], 5);
  EXPECT_EQ(last[1], 2);
}

}  // namespace
}  // namespace patina::texture_optimization
