// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/json_text.h"

#include <gtest/gtest.h>

namespace patina::http {
namespace {

TEST(JsonString, QuotesWhatWouldEndItAndReplacesWhatIsNoUtf8) {
  EXPECT_EQ(jsonString("a\"b\n"), "\"a\\\"b\\n\"");
  EXPECT_EQ(jsonString("\xff"), "\"\xef\xbf\xbd\"");
}

TEST(StringsOfJson, TakesAnObjectOfStringsAndNothingElse) {
  EXPECT_EQ(stringsOfJson("{\"a\":\"1\"}")->at("a"), "1");
  EXPECT_TRUE(stringsOfJson("{}")->empty());
  for (const std::string& wrong :
       {std::string(""), std::string("[]"), std::string("\"a\""), std::string("{\"a\":1}"),
        std::string("{\"a\":{}}"), std::string("{\"a\":null}"), std::string("{\"a\""),
        std::string(4000, '['), "{\"a\":\"" + std::string(4096, 'x') + "\"}"})
    EXPECT_FALSE(stringsOfJson(wrong)) << wrong.substr(0, 20);
}

}  // namespace
}  // namespace patina::http
