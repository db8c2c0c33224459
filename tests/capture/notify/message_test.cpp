// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/capture/notify/messages.h"

namespace patina::capture::notify {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

TEST(Message, SaysInItsSubjectHowBadWhereAndWhat) {
  EXPECT_EQ(subjectOf(cameraDown()), "[critical] banana: camera cam0 down");
  EXPECT_EQ(subjectOf(over()), "[critical] banana: camera cam0 down: over");
  EXPECT_EQ(subjectOf(run("the run begins")), "[info] banana: the run begins");
}

TEST(Message, SparesPeopleStatesFramesAndTheEndOfASingleMoment) {
  EXPECT_TRUE(isForPeople(cameraDown(), Severity::kCritical));
  EXPECT_TRUE(isForPeople(over(), Severity::kCritical));
  EXPECT_TRUE(isForPeople(test(), Severity::kCritical));
  EXPECT_FALSE(isForPeople(run("x"), Severity::kWarning));
  EXPECT_TRUE(isForPeople(run("x"), Severity::kInfo));
  EXPECT_FALSE(isForPeople(status(1), Severity::kInfo));
  EXPECT_FALSE(isForPeople(frame(), Severity::kInfo));
  Message moment = over();
  moment.news.momentary = true;
  EXPECT_FALSE(isForPeople(moment, Severity::kInfo));
  moment.news.times = 2;
  EXPECT_TRUE(isForPeople(moment, Severity::kInfo));
}

TEST(Message, HasASubjectOfOnePrintableLineWhateverItIsMadeOf) {
  Message m = cameraDown();
  m.news.subject = "cam0\r\nBcc: x@y\x01\xc3\xa4" + std::string(300, 'a');
  const std::string subject = subjectOf(m);
  EXPECT_EQ(subject.size(), 120u);
  for (const char c : subject) EXPECT_TRUE(c >= ' ' && c <= '~');
}

TEST(Message, TellsAPersonSinceWhenAndHowLong) {
  EXPECT_EQ(textOf(cameraDown()),
            "camera cam0 down\n"
            "twin 'cam0': collect: no picture within 12 s\n"
            "Since 2024-05-01T12:00:00.000Z, 7min so far.\n"
            "Run 20240501T120000Z-banana of banana on banana box, 2024-05-01T12:07:00.000Z\n");
  Message m = over();
  m.news.times = 9;
  m.dropped = 4;
  EXPECT_THAT(textOf(m), HasSubstr("Over after 7min"));
  EXPECT_THAT(textOf(m), HasSubstr("came and went 9 times"));
  EXPECT_THAT(textOf(m), HasSubstr("4 earlier messages"));
}

TEST(Message, HasTheSameKeysInJsonWhateverItTells) {
  std::vector<std::string> keys;
  for (const Message& m : {cameraDown(), over(), test(), run("x")}) {
    const auto json = nlohmann::ordered_json::parse(jsonOf(m));
    std::vector<std::string> its;
    for (const auto& [key, value] : json.items()) its.push_back(key);
    if (keys.empty()) keys = its;
    EXPECT_EQ(its, keys);
  }
  const auto json = nlohmann::json::parse(jsonOf(cameraDown()));
  EXPECT_EQ(json["schema"], "patina.alert/1");
  EXPECT_EQ(json["condition"], "camera_down");
  EXPECT_EQ(json["event"], "begins");
  EXPECT_EQ(json["subject"], "cam0");
  EXPECT_EQ(json["lasted_ns"], 420'000'000'000);
  EXPECT_THAT(json["text"].get<std::string>(), StartsWith("[critical] banana: camera cam0 down ("));
}

TEST(Message, StaysJsonWithQuotesControlsAndBrokenUtf8) {
  Message m = cameraDown();
  m.news.detail = "a \"b\" \\ \n \x01 \xff end";
  const auto json = nlohmann::json::parse(jsonOf(m));
  EXPECT_THAT(json["detail"].get<std::string>(), HasSubstr("\"b\" \\"));
  EXPECT_THAT(json["detail"].get<std::string>(), Not(HasSubstr("\n")));
}

}  // namespace
}  // namespace patina::capture::notify
