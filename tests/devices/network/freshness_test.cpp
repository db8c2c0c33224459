// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/network/freshness.h"

#include <gmock/gmock.h>

namespace patina::devices::network {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr UtcTime kNoon = utcFromNs(1'714'564'800'000'000'000);
constexpr MonoTime kOpened = monoFromNs(1'000'000'000'000);

HttpReply reply(Nanoseconds since_open, const std::string& body) {
  HttpReply r;
  for (const char c : body) r.body.push_back(static_cast<std::byte>(c));
  r.sent = kOpened + since_open - 50ms;
  r.first_byte = kOpened + since_open;
  return r;
}

TEST(Freshness, WithoutAnyDatesOnlyARepetitionIsStale) {
  Freshness fresh;
  const HttpReply first = reply(0s, "a");
  fresh.learn(first, kNoon, kOpened);
  fresh.remember(first);
  EXPECT_THAT(fresh.whyStale(reply(10s, "a"), kOpened + 9s), HasSubstr("previous picture"));
  EXPECT_EQ(fresh.whyStale(reply(10s, "b"), kOpened + 9s), "");
}

// Its clock is a day behind: only its own dates are compared.
TEST(Freshness, ModifiedBeforeTheTriggerByTheCamerasOwnClockIsStale) {
  Freshness fresh;
  HttpReply first = reply(0s, "a");
  first.date = kNoon - 24h;
  fresh.learn(first, kNoon, kOpened);
  HttpReply next = reply(100s, "b");
  next.date = kNoon - 24h + 100s;
  next.last_modified = kNoon - 24h + 95s;
  EXPECT_THAT(fresh.whyStale(next, kOpened + 99s), HasSubstr("modified before the trigger"));
  next.last_modified = kNoon - 24h + 99s;
  EXPECT_EQ(fresh.whyStale(next, kOpened + 99s), "");
}

TEST(Freshness, AnAnswerDatedBeforeTheTriggerComesFromACache) {
  Freshness fresh;
  HttpReply first = reply(0s, "a");
  first.date = kNoon;
  fresh.learn(first, kNoon, kOpened);
  HttpReply next = reply(100s, "b");
  next.date = kNoon + 50s;
  EXPECT_THAT(fresh.whyStale(next, kOpened + 99s), HasSubstr("dated before the trigger"));
  next.date = kNoon + 100s;
  next.age = 30s;
  EXPECT_THAT(fresh.whyStale(next, kOpened + 99s), HasSubstr("lay in a cache"));
}

TEST(Freshness, WithoutADateTheCameraIsTakenToHaveOurTime) {
  Freshness fresh;
  fresh.learn(reply(0s, "a"), kNoon, kOpened);
  HttpReply next = reply(100s, "b");
  next.last_modified = kNoon + 90s;
  EXPECT_THAT(fresh.whyStale(next, kOpened + 99s), HasSubstr("modified before the trigger"));
  next.last_modified = kNoon + 99s;
  EXPECT_EQ(fresh.whyStale(next, kOpened + 99s), "");
}

}  // namespace
}  // namespace patina::devices::network
