// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/hdf5_bridge.h"

#include <gtest/gtest.h>
#include <hdf5.h>

namespace patina::ttf::hdf5 {
namespace {

int closed = 0;
int countClose(Id) { return ++closed; }

TEST(Hdf5Handle, ClosesOnceHoweverItIsMoved) {
  closed = 0;
  {
    Handle first(7, countClose);
    Handle second = std::move(first);
    Handle third;
    third = std::move(second);
    EXPECT_EQ(third.id(), 7);
    EXPECT_TRUE(third.close());
    EXPECT_FALSE(third.valid());
  }
  EXPECT_EQ(closed, 1);
}

TEST(Hdf5Session, SilencesTheLibrarysOwnErrors) {
  ::testing::internal::CaptureStderr();
  {
    const Session session;
    EXPECT_LT(H5Fopen("/no/such/file.h5", H5F_ACC_RDONLY, H5P_DEFAULT), 0);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(Hdf5Checker, NamesTheFileAndSaysWhatTheCallerShouldDo) {
  const Checker check("a.h5", Exit::kBadData);
  try {
    check.handle(-1, H5Fclose, "is not a whole HDF5 file");
    FAIL();
  } catch (const ProcessingError& e) {
    EXPECT_STREQ(e.what(), "a.h5: is not a whole HDF5 file");
    EXPECT_EQ(e.exit(), Exit::kBadData);
  }
}

TEST(Hdf5Types, HalfHasTwoBytesAndTextItsLength) {
  const Session session;
  EXPECT_EQ(H5Tget_size(halfType().id()), 2u);
  EXPECT_EQ(H5Tget_size(textType(64).id()), 64u);
  EXPECT_GT(H5Tis_variable_str(anyTextType().id()), 0);
}

}  // namespace
}  // namespace patina::ttf::hdf5
