// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/sha256.h"

#include <gtest/gtest.h>

#include "processing/image/failure.h"
#include "tests/support/temp_folder.h"

namespace patina {
namespace {

constexpr char kOfAbc[] = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";

TEST(Sha256, GivesTheValuesOfFips180) {
  EXPECT_EQ(sha256(std::string_view("abc")).hex(), kOfAbc);
  EXPECT_EQ(sha256(std::string_view()).hex(),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Sha256, ReadsItsOwnTextAndNoOther) {
  EXPECT_EQ(Sha256::fromHex(kOfAbc), sha256(std::string_view("abc")));
  std::string upper = kOfAbc;
  upper[0] = 'B';
  EXPECT_THROW(Sha256::fromHex(upper), ProcessingError);
  EXPECT_THROW(Sha256::fromHex("ba78"), ProcessingError);
  EXPECT_THROW(Sha256::fromHex(""), ProcessingError);
}

TEST(Sha256, OfAFileAndOfAStreamAreThatOfItsBytes) {
  const testing::TempFolder folder;
  const std::string text(3'000'001, 'x');
  testing::writeFile(folder / "a", text);
  EXPECT_EQ(sha256OfFile(folder / "a"), sha256(text));
  Sha256Stream stream;
  for (std::size_t at = 0; at < text.size(); at += 4099)
    stream.add(
        std::as_bytes(std::span(text).subspan(at, std::min<std::size_t>(4099, text.size() - at))));
  EXPECT_EQ(stream.finish(), sha256(text));
  EXPECT_THROW(sha256OfFile(folder / "absent"), ProcessingError);
  EXPECT_THROW(sha256OfFile(folder.path()), ProcessingError);
}

}  // namespace
}  // namespace patina
