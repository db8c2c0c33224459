// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/credentials.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/capture/app/http/manual_clock.h"

namespace patina::http {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

TEST(NewToken, Is256BitsThatDoNotComeTwice) {
  std::set<std::string> seen;
  for (int i = 0; i < 1000; ++i) {
    const std::string token = newToken();
    EXPECT_EQ(token.size(), 64u);
    EXPECT_TRUE(seen.insert(token).second);
  }
}

TEST(Credentials, GivesABearerTheRoleOfItsTokenAndNobodyElseAny) {
  ManualClock clock;
  Credentials credentials(clock, {});
  const std::string viewer = credentials.addNamedToken("scraper", Role::kViewer);
  const std::string admin = credentials.addProcessToken(Role::kAdmin);
  EXPECT_EQ(credentials.roleOfBearer(viewer), Role::kViewer);
  EXPECT_EQ(credentials.roleOfBearer(admin), Role::kAdmin);
  for (const std::string& wrong :
       {std::string(), newToken(), viewer.substr(1), viewer + "0", sha256(viewer).hex()})
    EXPECT_EQ(credentials.roleOfBearer(wrong), Role::kPublic);
  EXPECT_EQ(credentials.roleOfSession(admin), Role::kPublic);
}

TEST(Credentials, WithdrawsANamedTokenAtOnce) {
  ManualClock clock;
  Credentials credentials(clock, {});
  const std::string token = credentials.addNamedToken("x", Role::kAdmin);
  EXPECT_TRUE(credentials.removeNamedToken("x"));
  EXPECT_FALSE(credentials.removeNamedToken("x"));
  EXPECT_EQ(credentials.roleOfBearer(token), Role::kPublic);
}

TEST(Credentials, RefusesASecondTokenOfANameAndARoleThatIsNone) {
  ManualClock clock;
  Credentials credentials(clock, {});
  credentials.addNamedToken("x", Role::kViewer);
  EXPECT_THROW(credentials.addNamedToken("x", Role::kAdmin), HttpError);
  EXPECT_THROW(credentials.addNamedToken("y", Role::kPublic), HttpError);
  EXPECT_THROW(credentials.addNamedToken("a b", Role::kViewer), HttpError);
}

TEST(Credentials, TakesATicketOnceAndWithinTenMinutes) {
  ManualClock clock;
  Credentials credentials(clock, {});
  const std::string used = credentials.newTicket(Role::kOperator),
                    late = credentials.newTicket(Role::kViewer);
  const auto session = credentials.exchangeTicket(used);
  ASSERT_TRUE(session);
  EXPECT_EQ(credentials.roleOfSession(*session), Role::kOperator);
  EXPECT_FALSE(credentials.exchangeTicket(used));
  EXPECT_EQ(credentials.roleOfBearer(*session), Role::kPublic);
  clock.advance(minutes(10));
  EXPECT_FALSE(credentials.exchangeTicket(late));
}

TEST(Credentials, EndsASessionAfterThirtyDays) {
  ManualClock clock;
  Credentials credentials(clock, {});
  const auto session = credentials.exchangeTicket(credentials.newTicket(Role::kViewer));
  clock.advance(std::chrono::days(30) - seconds(1));
  EXPECT_EQ(credentials.roleOfSession(*session), Role::kViewer);
  clock.advance(seconds(1));
  EXPECT_EQ(credentials.roleOfSession(*session), Role::kPublic);
}

TEST(Credentials, KeepsNoMoreThanSixteenTicketsAndSixtyFourSessions) {
  ManualClock clock;
  Credentials credentials(clock, {});
  const std::string first_ticket = credentials.newTicket(Role::kViewer);
  const auto first = credentials.exchangeTicket(credentials.newTicket(Role::kViewer));
  for (int i = 0; i < 64; ++i) credentials.exchangeTicket(credentials.newTicket(Role::kViewer));
  EXPECT_EQ(credentials.roleOfSession(*first), Role::kPublic);
  for (int i = 0; i < 16; ++i) credentials.newTicket(Role::kViewer);
  EXPECT_FALSE(credentials.exchangeTicket(first_ticket));
}

TEST(Credentials, LetsAPeerTryFiveTimesAMinute) {
  ManualClock clock;
  Credentials credentials(clock, {});
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(credentials.mayTryToLogIn("10.0.0.1"));
  EXPECT_FALSE(credentials.mayTryToLogIn("10.0.0.1"));
  EXPECT_TRUE(credentials.mayTryToLogIn("10.0.0.2"));
  clock.advance(seconds(60));
  EXPECT_TRUE(credentials.mayTryToLogIn("10.0.0.1"));
}

TEST(Credentials, CountsACrowdOfPeersTogether) {
  ManualClock clock;
  Credentials credentials(clock, {});
  for (int i = 0; i < 256; ++i) credentials.mayTryToLogIn(std::to_string(i));
  int allowed = 0;
  for (int i = 256; i < 300; ++i) allowed += credentials.mayTryToLogIn(std::to_string(i));
  EXPECT_EQ(allowed, 5);
}

}  // namespace
}  // namespace patina::http
