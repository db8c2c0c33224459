// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gpio/output_line.h"

#include <gmock/gmock.h>

#include <cstdlib>

#include "tests/support/matchers.h"

namespace patina::devices::gpio {
namespace {

using patina::testing::Fails;
using patina::testing::IsOk;
using ::testing::HasSubstr;

TEST(RequestLine, NamesTheChipsThatAreThereInsteadOfAMissingOne) {
  const auto line = requestLine({"no-such-chip", "1", false});
  ASSERT_THAT(line, Fails(Errc::kLost));
  EXPECT_THAT(line.error().what, HasSubstr("no-such-chip"));
  EXPECT_THAT(line.error().what, HasSubstr("there are: "));
}

// A chip whose lines may be driven: gpio-sim in the guest, or a bare board.
TEST(RequestLine, DrivesALineAndHoldsItAgainstOthers) {
  const char* chip = std::getenv("PATINA_GPIO_CHIP");
  if (chip == nullptr) GTEST_SKIP() << "PATINA_GPIO_CHIP names no chip whose line 1 may be driven";
  auto line = requestLine({chip, "1", false});
  ASSERT_THAT(line, IsOk());
  EXPECT_THAT((*line)->set(true), IsOk());
  EXPECT_THAT((*line)->set(false), IsOk());
  const auto second = requestLine({chip, "1", false});
  ASSERT_THAT(second, Fails(Errc::kBusy));
  EXPECT_THAT(second.error().what, HasSubstr("'patina'"));
  line->reset();
  EXPECT_THAT(requestLine({chip, "1", true}), IsOk());
  EXPECT_THAT(requestLine({chip, "no-such-line", false}), Fails(Errc::kLost));
}

}  // namespace
}  // namespace patina::devices::gpio
