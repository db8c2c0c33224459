// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/serial/escapes.h"

#include <gtest/gtest.h>

namespace patina::devices::serial {
namespace {

TEST(Escapes, BecomeTheBytesTheyStandFor) {
  EXPECT_EQ(unescape("ON\\r\\n"), "ON\r\n");
  EXPECT_EQ(unescape("\\xA0\\x01\\0\\\\"), std::string("\xa0\x01\0\\", 4));
  EXPECT_EQ(unescape(""), "");
}

TEST(Escapes, ThatAreNoneAreRefused) {
  for (const char* text : {"\\", "\\q", "\\x", "\\x1", "\\xg0", "ON\\x0"})
    EXPECT_EQ(unescape(text), std::nullopt) << text;
}

TEST(Escapes, MakeOneLineOfWhateverADeviceSays) {
  EXPECT_EQ(escape("a\nb\\\xff"), "a\\x0ab\\\\\\xff");
  EXPECT_EQ(escape(std::string(100, 'x')), std::string(60, 'x') + "...");
}

}  // namespace
}  // namespace patina::devices::serial
