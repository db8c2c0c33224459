// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/wire.h"

#include <gtest/gtest.h>

namespace patina::devices::host {
namespace {

TEST(Wire, FieldsComeBackAsTheyWere) {
  Writer to;
  to.u8(200);
  to.u16(40'000);
  to.u32(4'000'000'000);
  to.u64(1ull << 63);
  to.i64(-5);
  to.f64(-0.125);
  to.text("a lamp");
  const Bytes message = to.take();
  Reader from(message);
  EXPECT_EQ(from.u8(), 200);
  EXPECT_EQ(from.u16(), 40'000);
  EXPECT_EQ(from.u32(), 4'000'000'000);
  EXPECT_EQ(from.u64(), 1ull << 63);
  EXPECT_EQ(from.i64(), -5);
  EXPECT_EQ(from.f64(), -0.125);
  EXPECT_EQ(from.text(), "a lamp");
  EXPECT_TRUE(from.whole());
}

TEST(Wire, NumbersAreLittleEndian) {
  Writer to;
  to.u32(0x01020304);
  EXPECT_EQ(to.take(), (Bytes{std::byte{4}, std::byte{3}, std::byte{2}, std::byte{1}}));
}

TEST(Wire, AFieldThatIsNotThereIsNothingAndEverythingAfterIt) {
  Writer to;
  to.u64(1ull << 40);  // a length, and nothing behind it
  const Bytes message = to.take();
  Reader from(message);
  EXPECT_TRUE(from.bytes().empty());
  EXPECT_FALSE(from.ok());
  EXPECT_EQ(from.u8(), 0);
}

TEST(Wire, WhatIsLeftOverIsNoWholeMessage) {
  const Bytes two(2);
  Reader from(two);
  from.u8();
  EXPECT_TRUE(from.ok());
  EXPECT_FALSE(from.whole());
}

}  // namespace
}  // namespace patina::devices::host
