// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/http_call.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/capture/notify/receiver.h"

namespace patina::capture::notify {
namespace {

using namespace std::chrono_literals;
using patina::testing::Receiver;
using ::testing::HasSubstr;
using ::testing::Not;
using Result = Delivery::Result;

Delivery get(const std::string& url, Nanoseconds limit = 10s) {
  HttpCall request;
  request.url = url;
  request.limit = limit;
  return call(request, {});
}

TEST(HttpCall, PostsJsonWithItsToken) {
  Receiver receiver;
  HttpCall request;
  request.url = receiver.url("/a?b=c");
  request.body = R"({"x":1})";
  request.token = "hunter2";
  EXPECT_TRUE(call(request, {}).delivered());
  const auto got = receiver.requests().at(0);
  EXPECT_EQ(got.line, "POST /a?b=c HTTP/1.1");
  EXPECT_EQ(got.body, R"({"x":1})");
  EXPECT_THAT(got.head, HasSubstr("Content-Type: application/json"));
  EXPECT_THAT(got.head, HasSubstr("Authorization: Bearer hunter2"));
}

TEST(HttpCall, TriesAgainWhatMayPassAndNotWhatWillNot) {
  Receiver receiver;
  for (const int code : {408, 425, 429, 500, 502, 503}) {
    receiver.answerWith(Receiver::status(code));
    EXPECT_EQ(get(receiver.url()).result, Result::kTryAgain) << code;
  }
  for (const int code : {400, 401, 403, 404, 410}) {
    receiver.answerWith(Receiver::status(code));
    EXPECT_EQ(get(receiver.url()).result, Result::kRefused) << code;
  }
}

TEST(HttpCall, FollowsNoRedirect) {
  Receiver other;
  Receiver receiver;
  for (const int code : {301, 302, 303, 307, 308}) {
    receiver.answerWith(Receiver::status(code, "Location: " + other.url() + "\r\n"));
    const Delivery delivery = get(receiver.url());
    EXPECT_EQ(delivery.result, Result::kRefused);
    EXPECT_THAT(delivery.answer, HasSubstr("redirect"));
  }
  EXPECT_TRUE(other.requests().empty());
}

TEST(HttpCall, GivesUpOnAReceiverThatHangs) {
  Receiver receiver("");
  const Delivery delivery = get(receiver.url(), 100ms);
  EXPECT_EQ(delivery.result, Result::kTryAgain);
  EXPECT_EQ(delivery.answer, "no answer within 100ms");
}

TEST(HttpCall, GivesUpAtOnceWhenTheProgramEnds) {
  Receiver receiver("");
  std::stop_source hurry;
  std::thread other([&] {
    receiver.waitForRequests(1);
    hurry.request_stop();
  });
  HttpCall request;
  request.url = receiver.url();
  request.limit = 1h;
  EXPECT_EQ(call(request, hurry.get_token()).result, Result::kTryAgain);
  other.join();
}

TEST(HttpCall, TriesAgainWhenNobodyIsThere) {
  EXPECT_EQ(get("http://127.0.0.1:" + std::to_string(patina::testing::freePort()) + "/").result,
            Result::kTryAgain);
}

TEST(HttpCall, TakesNoAnswerWithoutEnd) {
  Receiver receiver("HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n" + std::string(1'000'000, 'x'));
  EXPECT_TRUE(get(receiver.url()).delivered());
  receiver.answerWith("no HTTP at all\r\n\r\n");
  EXPECT_EQ(get(receiver.url()).result, Result::kRefused);
}

TEST(HttpCall, SpeaksHttpAlone) {
  EXPECT_EQ(get("file:///etc/passwd").result, Result::kRefused);
  EXPECT_EQ(get("gopher://127.0.0.1/").result, Result::kRefused);
}

TEST(HttpCall, NamesAHostWithoutWhatIsSecret) {
  EXPECT_EQ(hostOf("https://hooks.example.org:8443/secret?x#y"), "hooks.example.org:8443");
  EXPECT_EQ(hostOf("https://me:hunter2@host/x@y"), "host");
  EXPECT_EQ(hostOf("http://host?secret"), "host");
  EXPECT_THAT(get("http://127.0.0.1:1/secret").answer, Not(HasSubstr("secret")));
}

}  // namespace
}  // namespace patina::capture::notify
