// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/network/http_get.h"

#include "tests/support/loopback/snapshots.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using network::HttpGet;
using network::httpGet;
using network::HttpReply;
using ::testing::HasSubstr;

class HttpGetting : public ::testing::Test {
 protected:
  // Answers every request by `answer`, and keeps what was asked.
  Result<HttpReply> getFrom(const LoopbackServer& server, Nanoseconds within = 20s) {
    HttpGet get;
    get.who = "network 'cam0'";
    get.url = "http://" + server.address() + "/snapshot.jpg";
    get.credentials = credentials;
    get.bytes_max = 100'000;
    get.connect_limit = 5s;
    began_ = clock_.mono();
    return httpGet(get, clock_, clock_.mono() + within);
  }
  Result<HttpReply> answeredBy(const std::string& answer, Nanoseconds within = 20s) {
    const LoopbackServer server([&](Peer& peer) {
      heads.push_back(peer.receiveHead());
      peer.send(answer);
    });
    return getFrom(server, within);
  }
  RealClock clock_;
  MonoTime began_;
  std::string credentials;
  std::vector<std::string> heads;
};

TEST_F(HttpGetting, GivesTheBodyAndWhatTheHeadSays) {
  const auto reply =
      answeredBy(ok("picture",
                    "Date: Wed, 01 May 2024 12:00:05 GMT\r\nLast-Modified: Wed, 01 May "
                    "2024 12:00:00 GMT\r\nAge: 7\r\n"));
  ASSERT_THAT(reply, IsOk());
  EXPECT_EQ(reply->body.size(), 7u);
  EXPECT_EQ(reply->content_type, "image/jpeg");
  EXPECT_EQ(reply->date, parseUtc("2024-05-01T12:00:05Z"));
  EXPECT_EQ(reply->last_modified, parseUtc("2024-05-01T12:00:00Z"));
  EXPECT_EQ(reply->age, 7s);
  EXPECT_GE(reply->sent, began_);
  EXPECT_GE(reply->first_byte, reply->sent);
}

TEST_F(HttpGetting, ADripDoesNotOutlastTheDeadline) {
  const LoopbackServer server([](Peer& peer) {
    peer.receiveHead();
    peer.send("HTTP/1.1 200 OK\r\nContent-Length: 50000\r\n\r\n");
    while (peer.send("x") && peer.waitForIt(10)) continue;
  });
  EXPECT_THAT(getFrom(server, 200ms), Fails(Errc::kTimeout));
}

TEST_F(HttpGetting, ASilentServerDoesNotOutlastTheDeadline) {
  const LoopbackServer server([](Peer& peer) {
    peer.receiveHead();
    while (peer.waitForIt(1000)) continue;
  });
  EXPECT_THAT(getFrom(server, 100ms), Fails(Errc::kTimeout));
}

TEST_F(HttpGetting, ABodyWithoutEndIsCutAtTheLimit) {
  const LoopbackServer server([](Peer& peer) {
    peer.receiveHead();
    peer.send("HTTP/1.1 200 OK\r\n\r\n");
    while (peer.send(std::string(4096, 'x'))) continue;
  });
  const auto reply = getFrom(server);
  ASSERT_THAT(reply, Fails(Errc::kCorrupt));
  EXPECT_THAT(reply.error().what, HasSubstr("longer than settings.bytes_max"));
}

TEST_F(HttpGetting, ABodyShorterThanItsLengthIsCorrupt) {
  EXPECT_THAT(answeredBy("HTTP/1.1 200 OK\r\nContent-Length: 100\r\n\r\nshort"),
              Fails(Errc::kCorrupt));
  EXPECT_THAT(answeredBy(""), Fails(Errc::kCorrupt));
}

TEST_F(HttpGetting, HeadersWithoutEndAreCorrupt) {
  const LoopbackServer server([](Peer& peer) {
    peer.receiveHead();
    peer.send("HTTP/1.1 200 OK\r\n");
    while (peer.send("X-More: " + std::string(1000, 'x') + "\r\n")) continue;
  });
  EXPECT_THAT(getFrom(server), Fails(Errc::kCorrupt));
}

TEST_F(HttpGetting, RedirectsStayOnTheHost) {
  int hops = 0;
  const LoopbackServer server([&](Peer& peer) {
    peer.receiveHead();
    peer.send(++hops < 4 ? status(302, "Location: /next" + std::to_string(hops) + "\r\n")
                         : ok("picture"));
  });
  EXPECT_THAT(getFrom(server), IsOk());
  hops = -100;
  EXPECT_THAT(getFrom(server), Fails(Errc::kRefused));

  const LoopbackServer other([](Peer& peer) { peer.send(ok("stolen")); });
  const auto away = answeredBy(status(301, "Location: http://" + other.address() + "/\r\n"));
  ASSERT_THAT(away, Fails(Errc::kRefused));
  EXPECT_THAT(away.error().what, HasSubstr("not followed"));
  EXPECT_EQ(other.connections(), 0);
  EXPECT_THAT(answeredBy(status(302, "Location: file:///etc/passwd\r\n")), Fails(Errc::kRefused));
}

TEST_F(HttpGetting, StatusesSayWhatToDo) {
  const auto forbidden = answeredBy(status(401));
  ASSERT_THAT(forbidden, Fails(Errc::kRefused));
  EXPECT_THAT(forbidden.error().what, HasSubstr("settings.credentials"));
  EXPECT_THAT(answeredBy(status(503)), Fails(Errc::kBusy));
  EXPECT_THAT(answeredBy(status(429)), Fails(Errc::kBusy));
  EXPECT_THAT(answeredBy(status(404)), Fails(Errc::kRefused));
  EXPECT_THAT(answeredBy(status(204)), Fails(Errc::kRefused));
}

TEST_F(HttpGetting, NobodyThereIsLost) {
  auto server = std::make_unique<LoopbackServer>([](Peer&) {});
  HttpGet get;
  get.url = "http://" + server->address() + "/";
  get.bytes_max = 1000;
  get.connect_limit = 5s;
  server.reset();
  EXPECT_THAT(httpGet(get, clock_, clock_.mono() + 20s), Fails(Errc::kLost));
}

TEST_F(HttpGetting, CredentialsAreGivenWhereTheyAreAskedFor) {
  credentials = "rig:pass";
  for (const std::string scheme :
       {"Basic realm=\"x\"", "Digest realm=\"x\", nonce=\"abc\", qop=\"auth\""}) {
    heads.clear();
    const LoopbackServer server([&](Peer& peer) {
      heads.push_back(peer.receiveHead());
      const bool asked = heads.back().find("Authorization: ") != std::string::npos;
      peer.send(asked ? ok("picture") : status(401, "WWW-Authenticate: " + scheme + "\r\n"));
    });
    EXPECT_THAT(getFrom(server), IsOk()) << scheme;
    EXPECT_THAT(heads.back(), HasSubstr("Authorization: " + scheme.substr(0, 5))) << scheme;
    EXPECT_EQ(heads.back().find("pass"), std::string::npos);
  }
}

}  // namespace
}  // namespace patina::testing
