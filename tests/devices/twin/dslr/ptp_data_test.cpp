// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/ptp_data.h"

#include <gtest/gtest.h>

#include "devices/twin/dslr/ptp_codes.h"

namespace patina::devices::twin::dslr {
namespace {

Bytes bytes(std::initializer_list<int> values) {
  Bytes out;
  for (const int v : values) out.push_back(static_cast<std::byte>(v));
  return out;
}

TEST(PtpWriter, WritesNumbersLowByteFirstAndTextsCounted) {
  PtpWriter out;
  out.u16(0x1014);
  out.u32(0x00010001);
  out.text("f8");
  out.text("");
  out.u16s({0x4002});
  EXPECT_EQ(out.take(),
            bytes({0x14, 0x10, 1, 0, 1, 0, 3, 'f', 0, '8', 0, 0, 0, 0, 1, 0, 0, 0, 0x02, 0x40}));
}

TEST(PtpReader, ReadsWhatTheWriterWrote) {
  PtpWriter out;
  out.u64(0x0123456789abcdef);
  out.text("PATN0001.JPG");
  out.u8(7);
  const Bytes written = out.take();
  PtpReader from(written);
  EXPECT_EQ(from.number(8), 0x0123456789abcdefu);
  EXPECT_EQ(from.text(), "PATN0001.JPG");
  EXPECT_EQ(from.u8(), 7);
  EXPECT_FALSE(from.bad());
  EXPECT_EQ(from.left(), 0u);
}

TEST(PtpReader, GivesZerosForEverOncePastTheEnd) {
  const Bytes three = bytes({1, 2, 3});
  PtpReader from(three);
  EXPECT_EQ(from.u32(), 0u);
  EXPECT_TRUE(from.bad());
  EXPECT_EQ(from.u8(), 0);
}

TEST(PtpReader, ReadsNoTextThatIsLongerThanItsBytes) {
  const Bytes lying = bytes({200, 'a', 0});
  PtpReader from(lying);
  EXPECT_EQ(from.text(), "");
  EXPECT_TRUE(from.bad());
}

TEST(Operation, HasANameOfItsOwnEach) {
  std::vector<std::string> names;
  for (const Operation operation : allOperations()) names.emplace_back(name(operation));
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  EXPECT_STREQ(name(static_cast<Operation>(0x9801)), "unknown");
}

}  // namespace
}  // namespace patina::devices::twin::dslr
