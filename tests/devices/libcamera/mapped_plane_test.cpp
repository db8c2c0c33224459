// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/mapped_plane.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

namespace patina::devices::libcamera {
namespace {

TEST(MappedPlane, ReadsItsPartAndNeverMore) {
  const int fd = ::memfd_create("plane", MFD_CLOEXEC);
  ASSERT_EQ(::write(fd, "abcdefgh", 8), 8);
  {
    const MappedPlane plane(fd, 2, 4);
    ASSERT_TRUE(plane.good());
    Bytes out;
    plane.appendTo(out, 3);
    plane.appendTo(out, 100);
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(out.data()), out.size()), "cdecdef");
  }
  ::close(fd);
}

TEST(MappedPlane, WhatCannotBeMappedSaysSo) { EXPECT_FALSE(MappedPlane(-1, 0, 4096).good()); }

}  // namespace
}  // namespace patina::devices::libcamera
