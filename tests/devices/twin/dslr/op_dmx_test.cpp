// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/op_dmx.h"

#include <gtest/gtest.h>

#include "tests/devices/twin/dslr/op_dmx_packet.h"

namespace patina::devices::twin::dslr {
namespace {

TEST(OpDmx, IsUniverseAndSlots) {
  const auto frame = parseOpDmx(opDmx(0x123, {1, 2, 255}));
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->universe, 0x123);
  EXPECT_EQ(frame->slots, (std::vector<std::uint8_t>{1, 2, 255}));
}

TEST(OpDmx, IsNothingWhenItIsCutShortOrAnother) {
  const Bytes good = opDmx(0, {1, 2, 3, 4});
  for (std::size_t length = 0; length < good.size(); ++length)
    EXPECT_FALSE(parseOpDmx(std::span(good).first(length))) << length;
  Bytes poll = good;
  poll[9] = std::byte{0x20};
  EXPECT_FALSE(parseOpDmx(poll));
  Bytes other = good;
  other[0] = std::byte{'B'};
  EXPECT_FALSE(parseOpDmx(other));
}

}  // namespace
}  // namespace patina::devices::twin::dslr
