// SPDX-License-Identifier: GPL-3.0-or-later
// The rules of the front door, asked of a real server over real sockets.
#include "capture/app/http/server.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <latch>

#include "tests/capture/app/http/served.h"

namespace patina::http {
namespace {

using std::chrono::seconds;

TEST(Server, AnswersEveryDocumentedOperationByRoleAlone) {
  const Served served;
  for (const Operation& one : documentedOperations()) {
    if (one.operation_id == "openSession") continue;  // what gives a token cannot ask for one
    const std::string path = exampleOf(one.pattern);
    EXPECT_EQ(served.ask(one.method, path).status, 401) << one.operation_id;
    EXPECT_EQ(served.ask(one.method, path, Served::bearer(std::string(64, '0'))).status, 401)
        << one.operation_id;
    for (const auto& [role, token] : {std::pair{Role::kViewer, served.viewer},
                                      {Role::kOperator, served.op},
                                      {Role::kAdmin, served.admin}}) {
      const int status = served.ask(one.method, path, Served::bearer(token)).status;
      if (role < one.role)
        EXPECT_EQ(status, 403) << one.operation_id << " as " << roleName(role);
      else
        EXPECT_TRUE(status == 200 || status == 400 || status == 404)
            << one.operation_id << " " << status;
    }
  }
}

TEST(Server, ServesTheSameRoutesOnBothSockets) {
  const Served served;
  for (const Operation& one : documentedOperations()) {
    if (one.operation_id == "streamEvents" || one.operation_id == "getMetrics") continue;
    const std::string request =
        served.request(one.method, exampleOf(one.pattern), Served::bearer(served.admin));
    EXPECT_EQ(served.local().ask(request).status,
              Wire::tcp(served.server->port()).ask(request).status)
        << one.operation_id;
  }
}

TEST(Server, RefusesTheNamesOfDnsRebindingOnEveryRoute) {
  const Served served;
  const std::string port = ":" + std::to_string(served.server->port());
  for (const std::string& host : {"evil.example" + port, "127.0.0.1.nip.io" + port,
                                  std::string("localhost"), std::string("127.0.0.1:1")})
    for (const std::string& path :
         {std::string("/"), std::string("/api/v1/status"), std::string("/events")}) {
      const WireReply reply = Wire::tcp(served.server->port())
                                  .ask("GET " + path + " HTTP/1.1\r\nHost: " + host + "\r\n" +
                                       Served::bearer(served.admin) + "\r\n");
      EXPECT_EQ(reply.status, 421) << host << path;
    }
}

TEST(Server, SignsABrowserInByALinkThatWorksOnce) {
  const Served served;
  const std::string link = served.server->newLink(Role::kOperator);
  ASSERT_TRUE(link.starts_with("http://" + served.host() + "/#t=")) << link;
  const std::string body = "{\"token\":\"" + link.substr(link.find("#t=") + 3) + "\"}";
  const std::string origin =
      "Sec-Fetch-Site: same-origin\r\nOrigin: http://" + served.host() + "\r\n";
  const WireReply opened = served.ask("POST", "/api/v1/session", origin, body);
  ASSERT_EQ(opened.status, 200);
  const std::string cookie = opened.fields.at("set-cookie");
  const std::string fields = origin + "Cookie: " + cookie.substr(0, cookie.find(';')) + "\r\n";
  EXPECT_EQ(served.ask("POST", "/api/v1/runs", fields).status, 200);
  EXPECT_EQ(served.ask("POST", "/api/v1/reload", fields).status, 403);
  EXPECT_EQ(served.ask("POST", "/api/v1/session", origin, body).status, 401);
}

TEST(Server, LimitsSignInsAcrossConnections) {
  const Served served;
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(served.ask("POST", "/api/v1/session", "", "{\"token\":\"x\"}").status, 401);
  const WireReply limited = served.ask("POST", "/api/v1/session", "", "{\"token\":\"x\"}");
  EXPECT_EQ(limited.status, 429);
  EXPECT_EQ(limited.fields.at("retry-after"), "60");
  served.server->newLink(Role::kViewer);
  const_cast<ManualClock&>(served.clock).advance(seconds(60));
  EXPECT_EQ(served.ask("POST", "/api/v1/session", "", "{\"token\":\"x\"}").status, 401);
}

TEST(Server, SendsNoCorsHeaderAndTheProtectiveOnesWithEveryAnswer) {
  const Served served;
  for (const std::string& path : {std::string("/"), std::string("/patina.js"),
                                  std::string("/api/v1/status"), std::string("/nothing")})
    for (const std::string& token : {std::string(), served.viewer}) {
      const WireReply reply =
          served.ask("GET", path, Served::bearer(token) + "Origin: http://evil.example\r\n");
      EXPECT_FALSE(reply.fields.contains("access-control-allow-origin")) << path;
      EXPECT_EQ(reply.fields.at("x-content-type-options"), "nosniff") << path;
      EXPECT_NE(reply.fields.at("content-security-policy").find("frame-ancestors 'none'"),
                std::string::npos)
          << path;
    }
  EXPECT_EQ(served.ask("OPTIONS", "/api/v1/runs", "Origin: http://evil.example\r\n").status, 405);
}

TEST(Server, WritesTheAdminsTokenForTheOwnerAloneAndTakesItAway) {
  auto served = std::make_unique<Served>();
  const auto file = served->options.token_file, socket = served->options.socket;
  struct stat facts {};
  ASSERT_EQ(stat(file.c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0600u);
  const std::string token = testing::readFile(file).substr(0, 64);
  EXPECT_EQ(served->ask("GET", "/api/v1/status", Served::bearer(token)).status, 200);
  served->server.reset();
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_FALSE(std::filesystem::exists(socket));
}

TEST(Server, RefusesToListenToTheWorldWithoutAPrivateLine) {
  ManualClock clock;
  Metrics metrics;
  const auto folder = testing::TempFolder::inMemory();
  ServerOptions options;
  options.listen = "0.0.0.0";
  options.port = 0;
  options.socket = folder / "s";
  options.named_tokens = folder / "tokens";
  const auto exit = [&] {
    try {
      const Server server(options, {}, clock, metrics);
    } catch (const HttpError& error) {
      return static_cast<int>(error.exit());
    }
    return 0;
  };
  EXPECT_EQ(exit(), 78);
  addKeptToken(options.named_tokens, "x", Role::kViewer);
  EXPECT_EQ(exit(), 78);
  EXPECT_FALSE(std::filesystem::exists(options.socket));
  options.behind_proxy = true;
  EXPECT_EQ(exit(), 0);
  options.behind_proxy = false;
  options.tls_certificate = folder / "cert";
  EXPECT_EQ(exit(), 78);
}

TEST(Server, AnswersHeadAsGetWithoutABody) {
  const Served served;
  const WireReply reply = served.ask("HEAD", "/api/v1/status", Served::bearer(served.viewer));
  EXPECT_EQ(reply.status, 200);
  EXPECT_NE(reply.fields.at("content-length"), "0");
}

TEST(Server, SendsThePageAgainOnlyWhenItHasChanged) {
  const Served served;
  const WireReply page = served.ask("GET", "/");
  EXPECT_EQ(page.fields.at("content-type"), "text/html; charset=utf-8");
  EXPECT_EQ(served.ask("GET", "/", "If-None-Match: " + page.fields.at("etag") + "\r\n").status,
            304);
}

TEST(Server, TurnsAHandlersFailureIntoAnAnswerAndHidesABug) {
  const Served served(
      {{"GET", "/full", Role::kViewer, "full",
        [](const Request&) -> Response { throw HttpError(Exit::kTemporary, "wait for it"); }},
       {"GET", "/bug", Role::kViewer, "bug",
        [](const Request&) -> Response { throw std::logic_error("/secret/path"); }}});
  const WireReply full = served.ask("GET", "/full", Served::bearer(served.viewer));
  EXPECT_EQ(full.status, 503);
  EXPECT_NE(full.body.find("wait for it"), std::string::npos);
  const WireReply bug = served.ask("GET", "/bug", Served::bearer(served.viewer));
  EXPECT_EQ(bug.status, 500);
  EXPECT_EQ(bug.body.find("secret"), std::string::npos);
}

TEST(Server, GoesOnAnsweringWhileAHandlerWaits) {
  std::latch entered(1), release(1);
  const Served served(
      {{"GET", "/slow", Role::kViewer, "slow",
        [&](const Request&) {
          entered.count_down();
          release.wait();
          return Response{};
        }},
       {"GET", "/quick", Role::kViewer, "quick", [](const Request&) { return Response{}; }}});
  Wire slow = Wire::tcp(served.server->port());
  slow.send(served.request("GET", "/slow", Served::bearer(served.viewer)));
  entered.wait();
  EXPECT_EQ(served.ask("GET", "/quick", Served::bearer(served.viewer)).status, 200);
  release.count_down();
  EXPECT_EQ(slow.reply().status, 200);
}

TEST(Server, StopsWhileClientsAreInTheMiddleOfEverything) {
  auto served = std::make_unique<Served>();
  Wire idle = Wire::tcp(served->server->port()), half = Wire::tcp(served->server->port()),
       stream = served->local();
  half.send("GET / HT");
  EXPECT_EQ(idle.ask(served->request("GET", "/")).status, 200);
  EXPECT_EQ(stream.ask(served->request("GET", "/events")).status, 200);
  served->server.reset();
  EXPECT_TRUE(idle.ended());
  EXPECT_TRUE(half.ended());
  EXPECT_TRUE(stream.ended());
}

}  // namespace
}  // namespace patina::http
