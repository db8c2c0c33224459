// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/own_routes.h"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "capture/app/http/page_files.h"
#include "tests/capture/app/http/manual_clock.h"
#include "tests/capture/app/http/open_api.h"

namespace patina::http {
namespace {

class OwnRoutesTest : public ::testing::Test {
 protected:
  Response ask(const std::string& operation_id, const std::string& body,
               const std::string& peer = "p") {
    for (const Route& route : routes)
      if (route.operation_id == operation_id) {
        Request request;
        request.body = body;
        request.peer = peer;
        request.parameters["name"] = "x";
        try {
          return route.handler(request);
        } catch (const Failure& failure) {
          return errorResponse(failure);
        }
      }
    throw std::logic_error("no such operation");
  }

  ManualClock clock;
  Credentials credentials{clock, {}};
  std::vector<Route> routes =
      ownRoutes({.credentials = credentials,
                 .cookie = "patina_session_8460",
                 .cookie_over_tls_only = false,
                 .link = [](const std::string& ticket) { return "http://h/#t=" + ticket; },
                 .metrics_text = [] { return std::string("metrics"); }});
};

TEST_F(OwnRoutesTest, AreDocumentedWithTheirRolesAndPatterns) {
  std::set<std::string> documented;
  for (const Operation& one : documentedOperations())
    documented.insert(one.operation_id + " " + one.method + " " + one.pattern + " " +
                      roleName(one.role));
  for (const Route& route : routes) {
    if (route.operation_id.starts_with("page")) continue;  // the page's files are no interface
    EXPECT_TRUE(documented.contains(route.operation_id + " " + route.method + " " + route.pattern +
                                    " " + roleName(route.role)))
        << route.operation_id;
  }
}

TEST_F(OwnRoutesTest, ArePublicOnlyForTheExchangeAndThePage) {
  for (const Route& route : routes)
    EXPECT_EQ(route.role == Role::kPublic,
              route.operation_id == "openSession" || route.operation_id.starts_with("page"))
        << route.operation_id;
}

TEST_F(OwnRoutesTest, ExchangeALinkForACookieThatScriptsAndOtherSitesCannotUse) {
  const Response response =
      ask("openSession", "{\"token\":\"" + credentials.newTicket(Role::kViewer) + "\"}");
  EXPECT_EQ(response.status, 200);
  const std::string cookie = response.headers.at("Set-Cookie");
  EXPECT_TRUE(cookie.starts_with("patina_session_8460="));
  for (const char* word : {"; HttpOnly", "; SameSite=Strict", "; Path=/"})
    EXPECT_NE(cookie.find(word), std::string::npos) << word;
  EXPECT_EQ(credentials.roleOfSession(cookie.substr(cookie.find('=') + 1, 64)), Role::kViewer);
}

TEST_F(OwnRoutesTest, AnswerTheSixthSignInWithinAMinuteWith429) {
  for (int i = 0; i < 5; ++i) EXPECT_EQ(ask("openSession", "{\"token\":\"wrong\"}").status, 401);
  const std::string good = "{\"token\":\"" + credentials.newTicket(Role::kViewer) + "\"}";
  EXPECT_EQ(ask("openSession", good).status, 429);
  EXPECT_EQ(ask("openSession", good, "another peer").status, 200);
}

TEST_F(OwnRoutesTest, MakeALinkOfARoleAndRefuseAnyOtherWord) {
  EXPECT_NE(ask("createTicket", "{\"role\":\"viewer\"}").body.find("\"url\":\"http://h/#t="),
            std::string::npos);
  for (const char* body :
       {"", "{}", "{\"role\":\"root\"}", "{\"role\":1}", "{\"role\":\"viewer\",\"more\":\"x\"}"})
    EXPECT_EQ(ask("createTicket", body).status, 400) << body;
}

TEST_F(OwnRoutesTest, MakeAndWithdrawANamedToken) {
  const std::string body = ask("createToken", "{\"name\":\"x\",\"role\":\"viewer\"}").body;
  const std::string token = body.substr(body.find("\"token\":\"") + 9, 64);
  EXPECT_EQ(credentials.roleOfBearer(token), Role::kViewer);
  EXPECT_EQ(ask("deleteToken", "").status, 200);
  EXPECT_EQ(credentials.roleOfBearer(token), Role::kPublic);
  EXPECT_EQ(ask("deleteToken", "").status, 404);
}

TEST(Page, HasNoInlineScriptNoInlineStyleAndWritesTextOnly) {
  for (const PageFile& file : pageFiles()) {
    for (const char* banned :
         {"innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(",
          "onclick=", "onload=", "style=", "<style", "javascript:", "https://", "new Function"})
      EXPECT_EQ(file.text.find(banned), std::string::npos) << file.path << ": " << banned;
    const bool has_script = file.text.find("<script") != std::string::npos;
    EXPECT_EQ(has_script, file.path == "/") << file.path;
  }
  EXPECT_NE(pageFiles().front().text.find("<script type=\"module\" src=\"/patina.js\"></script>"),
            std::string::npos);
}

}  // namespace
}  // namespace patina::http
