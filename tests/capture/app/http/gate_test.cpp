// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/gate.h"

#include <gtest/gtest.h>

#include "capture/app/http/fields.h"
#include "tests/capture/app/http/manual_clock.h"

namespace patina::http {
namespace {

class GateTest : public ::testing::Test {
 protected:
  GateTest() { head.fields = {{"Host", "localhost:8460"}}; }

  int status() const {
    return Gate(rules, table, credentials).admit(head).refusal.value_or(Response{}).status;
  }
  Admission admitted() const { return Gate(rules, table, credentials).admit(head); }
  void field(const std::string& name, const std::string& value) {
    std::erase_if(head.fields, [&](const auto& one) { return one.first == name; });
    head.fields.emplace_back(name, value);
  }
  void post() {
    head.method = "POST";
    head.target = "/runs";
    field("Content-Type", "application/json");
    field("Authorization", "Bearer " + op);
  }

  ManualClock clock;
  Credentials credentials{clock, {}};
  const std::string viewer = credentials.addNamedToken("v", Role::kViewer);
  const std::string op = credentials.addNamedToken("o", Role::kOperator);
  const RouteTable table{{{"GET", "/", Role::kPublic, "page", {}},
                          {"GET", "/status", Role::kViewer, "status", {}},
                          {"POST", "/runs", Role::kOperator, "start", {}},
                          {"POST", "/session", Role::kPublic, "session", {}},
                          {"DELETE", "/tokens/{name}", Role::kAdmin, "delete", {}}}};
  GateRules rules{
      .scheme = "http", .hosts = allowedHosts(8460, {}, false), .cookie = "patina_session_8460"};
  RequestHead head{
      .method = "GET", .target = "/status", .fields = {}, .header_bytes = 100, .peer = "127.0.0.1"};
};

TEST_F(GateTest, AnswersNobodyWithoutAToken) {
  EXPECT_EQ(status(), 401);
  EXPECT_EQ(admitted().refusal->headers.at("WWW-Authenticate"), "Bearer realm=\"patina\"");
  head.target = "/no-such-thing";  // nor does it tell what there is
  EXPECT_EQ(status(), 401);
  field("Authorization", "Bearer " + std::string(64, '0'));
  EXPECT_EQ(status(), 401);
}

TEST_F(GateTest, LetsAViewerLookAndNotAct) {
  field("Authorization", "Bearer " + viewer);
  EXPECT_EQ(status(), 200);
  EXPECT_EQ(admitted().request.role, Role::kViewer);
  post();
  field("Authorization", "Bearer " + viewer);
  EXPECT_EQ(status(), 403);
}

TEST_F(GateTest, JudgesWhoeverShowsATokenByThatToken) {
  const auto session = credentials.exchangeTicket(credentials.newTicket(Role::kAdmin));
  field("Cookie", "patina_session_8460=" + *session);
  EXPECT_EQ(admitted().request.role, Role::kAdmin);
  field("Authorization", "Bearer wrong");
  EXPECT_EQ(status(), 401);
  head.local = true;
  head.local_role = Role::kAdmin;
  EXPECT_EQ(status(), 401);
}

TEST_F(GateTest, TakesNoCookieOfAnotherNameAndNoTokenAsCookie) {
  const auto session = credentials.exchangeTicket(credentials.newTicket(Role::kAdmin));
  field("Cookie", "patina_session_8461=" + *session);
  EXPECT_EQ(status(), 401);
  field("Cookie", "patina_session_8460=" + viewer);
  EXPECT_EQ(status(), 401);
}

TEST_F(GateTest, TrustsTheOwnerAtTheUnixSocketAndNoOtherPeer) {
  head.local = true;
  head.fields.clear();
  EXPECT_EQ(status(), 401);
  head.local_role = Role::kAdmin;
  EXPECT_EQ(status(), 200);
  EXPECT_TRUE(admitted().request.local);
}

TEST_F(GateTest, RefusesAHostThatIsNotItsOwnEvenForItsPage) {
  field("Authorization", "Bearer " + op);
  head.target = "/";
  EXPECT_EQ(status(), 200);
  field("Host", "evil.example:8460");
  EXPECT_EQ(status(), 421);
  head.fields.erase(head.fields.begin());
  std::erase_if(head.fields, [](const auto& one) { return one.first == "Host"; });
  EXPECT_EQ(status(), 421);
}

TEST_F(GateTest, TrustsNoHeaderOfAProxy) {
  head.fields = {{"Host", "evil.example"},
                 {"X-Forwarded-Host", "localhost:8460"},
                 {"Forwarded", "host=\"localhost:8460\""}};
  EXPECT_EQ(status(), 421);
}

TEST_F(GateTest, RefusesAFieldThatTwoProgramsCouldReadInTwoWays) {
  field("Authorization", "Bearer " + op);
  for (const char* name : {"host", "Authorization", "cookie", "Origin", "Content-Length",
                           "transfer-encoding", "Range"}) {
    auto fields = head.fields;
    head.fields.emplace_back(name, "localhost:8460");
    head.fields.emplace_back(name, "localhost:8460");
    EXPECT_EQ(status(), 400) << name;
    head.fields = fields;
  }
  post();
  field("Content-Length", "2");
  field("Transfer-Encoding", "chunked");
  EXPECT_EQ(status(), 400);
}

TEST_F(GateTest, RefusesWhatAPageOfAnotherSiteAsks) {
  post();
  for (const char* site : {"cross-site", "same-site"}) {
    field("Sec-Fetch-Site", site);
    EXPECT_EQ(status(), 403) << site;
  }
  field("Sec-Fetch-Site", "same-origin");
  EXPECT_EQ(status(), 200);
  std::erase_if(head.fields, [](const auto& one) { return one.first == "Sec-Fetch-Site"; });
  field("Origin", "http://evil.example");
  EXPECT_EQ(status(), 403);
  field("Origin", "http://localhost:8460");
  EXPECT_EQ(status(), 200);
}

TEST_F(GateTest, RefusesACrossSiteSignIn) {
  head.method = "POST";
  head.target = "/session";
  field("Content-Type", "application/json");
  EXPECT_EQ(status(), 200);
  field("Sec-Fetch-Site", "cross-site");
  EXPECT_EQ(status(), 403);
}

TEST_F(GateTest, RefusesCrossSiteReadsOfDataAndOpensThePageFromALink) {
  field("Authorization", "Bearer " + op);
  field("Sec-Fetch-Site", "cross-site");
  EXPECT_EQ(status(), 403);
  head.target = "/";
  EXPECT_EQ(status(), 200);
}

TEST_F(GateTest, WantsJsonForEveryPost) {
  post();
  EXPECT_EQ(status(), 200);
  field("Content-Type", "text/plain");
  EXPECT_EQ(status(), 415);
  std::erase_if(head.fields, [](const auto& one) { return one.first == "Content-Type"; });
  EXPECT_EQ(status(), 415);
}

TEST_F(GateTest, ReadsNoBodyOverItsLimit) {
  post();
  field("Content-Length", std::to_string(1 << 20));
  EXPECT_EQ(admitted().body_bytes_expected, 1u << 20);
  field("Content-Length", std::to_string((1 << 20) + 1));
  EXPECT_EQ(status(), 413);
  for (const char* length : {"-1", "1e3", "0x10", "99999999999999999999", "", "+1", "1 "}) {
    field("Content-Length", length);
    EXPECT_EQ(status(), 400) << length;
  }
}

TEST_F(GateTest, ReadsLittleFromThoseItDoesNotKnow) {
  head.method = "POST";
  head.target = "/session";
  field("Content-Type", "application/json");
  field("Content-Length", "4096");
  EXPECT_EQ(status(), 200);
  field("Content-Length", "4097");
  EXPECT_EQ(status(), 413);
}

TEST_F(GateTest, SaysNoToTheUnknownBeforeItLooksAtTheirBody) {
  post();
  field("Authorization", "Bearer wrong");
  field("Content-Length", "999999999");
  EXPECT_EQ(status(), 401);
}

TEST_F(GateTest, TakesNoBodyWhereNoneBelongs) {
  field("Authorization", "Bearer " + op);
  field("Content-Length", "1");
  EXPECT_EQ(status(), 400);
  field("Content-Length", "0");
  EXPECT_EQ(status(), 200);
  field("Transfer-Encoding", "chunked");
  EXPECT_EQ(status(), 400);
}

TEST_F(GateTest, RefusesAHeaderOver16KiB) {
  field("Authorization", "Bearer " + op);
  head.header_bytes = 16 << 10;
  EXPECT_EQ(status(), 200);
  ++head.header_bytes;
  EXPECT_EQ(status(), 431);
}

TEST_F(GateTest, TellsThoseItKnowsWhatIsNotThereAndWhatToUse) {
  field("Authorization", "Bearer " + op);
  head.target = "/nothing";
  EXPECT_EQ(status(), 404);
  head.target = "/runs";
  EXPECT_EQ(status(), 405);
  EXPECT_EQ(admitted().refusal->headers.at("Allow"), "POST");
  head.method = "PATCH";
  EXPECT_EQ(status(), 405);
  head.method = "TRACE";
  EXPECT_EQ(status(), 405);
}

TEST_F(GateTest, HandsOnTheQueryDecodedAndRefusesOneItCannotRead) {
  field("Authorization", "Bearer " + op);
  head.target = "/status?after=1&camera=a%20b";
  EXPECT_EQ(admitted().request.query.at("camera"), "a b");
  EXPECT_EQ(admitted().request.path, "/status");
  head.target = "/status?a=1&a=2";
  EXPECT_EQ(status(), 400);
}

}  // namespace
}  // namespace patina::http
