// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/fields.h"

#include <gtest/gtest.h>

namespace patina::http {
namespace {

const std::vector<std::string> kHosts = allowedHosts(8460, {"rig.lab"}, false);

TEST(HostAllowed, TakesOurOwnNamesWithOurPort) {
  for (const char* host :
       {"localhost:8460", "LOCALHOST:8460", "127.0.0.1:8460", "[::1]:8460", "rig.lab:8460"})
    EXPECT_TRUE(hostAllowed(host, kHosts)) << host;
}

TEST(HostAllowed, RefusesNamesThatDnsRebindingWouldUse) {
  for (const char* host : {"",
                           "localhost",
                           "127.0.0.1",
                           "rig.lab",
                           "localhost:80",
                           "127.0.0.1:84600",
                           "evil.example:8460",
                           "127.0.0.1.evil.example:8460",
                           "localhost.evil.example:8460",
                           "127.0.0.1.nip.io:8460",
                           "localhost:8460.evil.example",
                           "localhost:8460@evil.example",
                           "127.1:8460",
                           "0.0.0.0:8460",
                           "2130706433:8460",
                           "0x7f000001:8460",
                           "127.0.0.1:8460 ",
                           "localhost.:8460",
                           "[::]:8460",
                           "[::ffff:127.0.0.1]:8460",
                           "xrig.lab:8460"})
    EXPECT_FALSE(hostAllowed(host, kHosts)) << host;
}

TEST(AllowedHosts, LeaveThePortOutOnlyForConfiguredNamesBehindTls) {
  const auto hosts = allowedHosts(8460, {"rig.lab"}, true);
  EXPECT_TRUE(hostAllowed("rig.lab", hosts));
  EXPECT_FALSE(hostAllowed("localhost", hosts));
}

TEST(FromOurSite, BelievesSecFetchSiteBeforeAnythingElse) {
  EXPECT_TRUE(fromOurSite("same-origin", "http://evil.example", "http", kHosts));
  EXPECT_TRUE(fromOurSite("none", {}, "http", kHosts));
  for (const char* site : {"cross-site", "same-site", "", "Same-Origin"})
    EXPECT_FALSE(fromOurSite(site, "http://localhost:8460", "http", kHosts)) << site;
}

TEST(FromOurSite, FallsBackToAnOriginThatMustBeOurs) {
  EXPECT_TRUE(fromOurSite({}, "http://127.0.0.1:8460", "http", kHosts));
  EXPECT_TRUE(fromOurSite({}, {}, "http", kHosts));  // no browser
  for (const char* origin : {"null", "", "https://127.0.0.1:8460", "http://127.0.0.1",
                             "http://evil.example:8460", "http://localhost:8460/", "file://"})
    EXPECT_FALSE(fromOurSite({}, origin, "http", kHosts)) << origin;
}

TEST(CookieValue, FindsTheWholeNameOnly) {
  EXPECT_EQ(cookieValue("a=1; patina=x=y; b", "patina"), "x=y");
  EXPECT_EQ(cookieValue("xpatina=1;patina=2", "patina"), "2");
  EXPECT_EQ(cookieValue("patina=first; patina=second", "patina"), "first");
  EXPECT_FALSE(cookieValue("patina", "patina"));
  EXPECT_FALSE(cookieValue("", "patina"));
}

TEST(BearerToken, RefusesWhatIsNoToken) {
  EXPECT_EQ(bearerToken("Bearer abc-._~+/="), "abc-._~+/=");
  EXPECT_EQ(bearerToken("bearer abc"), "abc");
  for (const std::string& field :
       {std::string(""), std::string("Bearer "), std::string("Basic abc"),
        std::string("Bearer a b"), std::string("Bearer a\tb"), "Bearer " + std::string(257, 'a'),
        std::string("Bearer")})
    EXPECT_FALSE(bearerToken(field)) << field;
}

TEST(IsJsonType, TakesNoTypeThatAFormCanSend) {
  EXPECT_TRUE(isJsonType("application/json"));
  EXPECT_TRUE(isJsonType("Application/JSON ; charset=UTF-8"));
  for (const char* type :
       {"", "text/plain", "application/x-www-form-urlencoded", "multipart/form-data",
        "application/jsonp", "text/plain; application/json", "application/json; charset=utf-7"})
    EXPECT_FALSE(isJsonType(type)) << type;
}

TEST(ParseQuery, DecodesOnceAndRefusesWhatIsAmbiguous) {
  const auto query = parseQuery("camera=left%20cam&light=a%2Bb&empty=&flag");
  ASSERT_TRUE(query);
  EXPECT_EQ(query->at("camera"), "left cam");
  EXPECT_EQ(query->at("light"), "a+b");
  EXPECT_EQ(query->at("flag"), "");
  EXPECT_EQ(parseQuery("a=%252e")->at("a"), "%2e");
  for (const char* wrong : {"a=1&a=2", "a=%", "a=%0", "a=%zz", "a=%00", "=1", "&&=", "%"})
    EXPECT_FALSE(parseQuery(wrong)) << wrong;
}

TEST(ParseQuery, TakesNoMoreThan32Pairs) {
  std::string query;
  for (int i = 0; i < 32; ++i) query += (i ? "&k" : "k") + std::to_string(i) + "=1";
  EXPECT_TRUE(parseQuery(query));
  EXPECT_FALSE(parseQuery(query + "&more=1"));
}

}  // namespace
}  // namespace patina::http
