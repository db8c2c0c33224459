// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

TEST(Devices, AreListedWithWhatIsWrongWithThem) {
  const JsonAnswer told = answerOf(runPatina({"devices", "--json"}));
  for (std::size_t i = 0; i < told.size("/items"); ++i) {
    const std::string at = "/items/" + std::to_string(i);
    EXPECT_NE(told.text(at + "/kind"), "");
    EXPECT_NE(told.text(at + "/backend"), "");
  }
}

TEST(Devices, OneThatIsNotThereIsUnavailable) {
  const Finished none = runPatina({"devices", "show", "no-such-serial"});
  EXPECT_EQ(none.exit, 69);
  EXPECT_THAT(none.err, HasSubstr("no device 'no-such-serial'"));
}

}  // namespace
}  // namespace patina::testing
