// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/byte_range.h"

#include <gtest/gtest.h>

namespace patina::http {
namespace {

void expectPart(const char* field, std::uint64_t first, std::uint64_t bytes) {
  const ByteRange range = chooseRange(field, 100);
  EXPECT_EQ(range.kind, ByteRange::kPart) << field;
  EXPECT_EQ(range.first, first) << field;
  EXPECT_EQ(range.bytes, bytes) << field;
}

TEST(ChooseRange, GivesOneRangeInsideTheFile) {
  expectPart("bytes=0-9", 0, 10);
  expectPart("bytes=90-", 90, 10);
  expectPart("bytes=-10", 90, 10);
  expectPart("bytes=-1000", 0, 100);
  expectPart("bytes=99-18446744073709551615", 99, 1);
}

TEST(ChooseRange, GivesTheWholeWhenNothingIsAsked) {
  const ByteRange range = chooseRange("", 100);
  EXPECT_EQ(range.kind, ByteRange::kWhole);
  EXPECT_EQ(range.bytes, 100u);
}

TEST(ChooseRange, RefusesARangeBombAndWhateverMakesNoSense) {
  std::string bomb = "bytes=0-";
  for (int i = 0; i < 1000; ++i) bomb += ",0-";
  for (const std::string& field :
       {bomb, std::string("bytes=0-1,2-3"), std::string("bytes=100-"), std::string("bytes=5-4"),
        std::string("bytes=-0"), std::string("bytes=-"), std::string("bytes="),
        std::string("items=0-1"), std::string("bytes=a-b"), std::string("bytes= 0-1"),
        std::string("bytes=0-18446744073709551616"), std::string("bytes=--1"), std::string("0-1")})
    EXPECT_EQ(chooseRange(field, 100).kind, ByteRange::kRefused) << field;
  EXPECT_EQ(chooseRange("bytes=0-", 0).kind, ByteRange::kRefused);
}

}  // namespace
}  // namespace patina::http
