// SPDX-License-Identifier: GPL-3.0-or-later
// Clients that are slow, greedy or many.
#include "capture/app/http/listener.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "tests/capture/app/http/served.h"

namespace patina::http {
namespace {

using std::chrono::seconds;

constexpr double kMostGrowth = 32 << 20;

double residentBytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// Memory of the whole process, the clients' own included.
class Growth {
 public:
  double bytes() const { return residentBytes() - before_; }

 private:
  double before_ = residentBytes();
};

// Sanitizers keep what was freed.
bool memoryCanBeJudged() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return false;
#else
  return true;
#endif
}

void expectSmall(const Growth& growth) {
  ::testing::Test::RecordProperty("growth_bytes", std::to_string(growth.bytes()));
  if (memoryCanBeJudged()) {
    EXPECT_LT(growth.bytes(), kMostGrowth);
  }
}

void waitFor(const Served& served, const std::string& series, double value) {
  while (served.metric(series) != value) continue;
}

TEST(Listener, HangsUpOnAHeaderThatTakesMoreThanFiveSeconds) {
  Served served;
  Wire slow = Wire::tcp(served.server->port());
  slow.send("GET / HTTP/1.1\r\nHost: ");
  waitFor(served, "patina_http_connections", 2);  // the one that asks, and ours
  served.clock.advance(seconds(4));
  slow.send("127.0.0.1");  // a byte now and then buys no time
  served.clock.advance(seconds(1));
  EXPECT_TRUE(slow.ended());
  waitFor(served, "patina_http_late_total", 1);
}

TEST(Listener, HangsUpOnAConnectionThatIdlesFor30Seconds) {
  Served served;
  Wire idle = Wire::tcp(served.server->port());
  EXPECT_EQ(idle.ask(served.request("GET", "/")).status, 200);
  EXPECT_EQ(idle.ask(served.request("GET", "/")).status, 200);  // kept alive until then
  served.ask("GET", "/");  // by the same thread: after it, the idling has begun
  served.clock.advance(seconds(29));
  EXPECT_EQ(served.metric("patina_http_late_total"), 0);
  served.clock.advance(seconds(1));
  EXPECT_TRUE(idle.ended());
}

TEST(Listener, HangsUpOnABodyThatDoesNotCome) {
  Served served;
  Wire slow = Wire::tcp(served.server->port());
  slow.send("POST /api/v1/runs HTTP/1.1\r\nHost: " + served.host() +
            "\r\nContent-Type: application/json\r\n" + Served::bearer(served.op) +
            "Expect: 100-continue\r\nContent-Length: 10\r\n\r\n");
  EXPECT_EQ(slow.reply().status, 100);
  slow.send("{");
  served.clock.advance(seconds(31));
  EXPECT_TRUE(slow.ended());
}

TEST(Listener, GivesOnePeerSixteenConnectionsAndOthersTheirs) {
  Served served;
  std::vector<Wire> all;
  for (int i = 0; i < 16; ++i) {
    all.push_back(Wire::tcp(served.server->port()));
    EXPECT_EQ(all.back().ask(served.request("GET", "/")).status, 200) << i;
  }
  EXPECT_EQ(served.ask("GET", "/").status, 0);
  EXPECT_EQ(Wire::tcp(served.server->port(), "127.0.0.2").ask(served.request("GET", "/")).status,
            200);
}

TEST(Listener, KeepsTheUnixSocketFreeWhenTcpIsFull) {
  Served served;
  std::vector<Wire> all;
  for (int i = 0; i < 48; ++i) {
    all.push_back(Wire::tcp(served.server->port(), "127.0.0." + std::to_string(2 + i / 16)));
    EXPECT_EQ(all.back().ask(served.request("GET", "/")).status, 200) << i;
  }
  Wire waiting = Wire::tcp(served.server->port(), "127.0.0.9");
  waiting.send(served.request("GET", "/"));
  EXPECT_EQ(served.metric("patina_http_connections"), 49);
  all.front().hangUp();
  EXPECT_EQ(waiting.reply().status, 200);
}

TEST(Listener, RefusesAHeaderOfMoreThan16KiB) {
  const Served served;
  const auto padded = [&served](std::size_t bytes) {
    return served.ask("GET", "/", "X: " + std::string(bytes, 'x') + "\r\n").status;
  };
  EXPECT_EQ(padded(15 << 10), 200);
  EXPECT_EQ(padded(17 << 10), 431);
  EXPECT_GE(padded(64 << 10), 400);
}

TEST(Listener, StaysSmallUnderAHeaderOf300MBWithoutNewline) {
  const Served served;
  served.ask("GET", "/");
  const std::string block(1 << 20, 'x');
  const Growth growth;
  for (const std::string& start :
       {std::string(), "GET / HTTP/1.1\r\nHost: " + served.host() + "\r\nX: "}) {
    Wire wire = Wire::tcp(served.server->port());
    wire.send(start);
    int sent_mb = 0;
    while (sent_mb < 300 && wire.send(block)) ++sent_mb;
    EXPECT_LT(sent_mb, 300);  // it hangs up long before
  }
  expectSmall(growth);
}

TEST(Listener, StaysSmallUnderAChunkedBomb) {
  const Served served;
  served.ask("GET", "/");
  const std::string block = "100000\r\n" + std::string(1 << 20, 'x') + "\r\n";
  const Growth growth;
  for (int i = 0; i < 4; ++i) {
    Wire wire = Wire::tcp(served.server->port());
    wire.send("POST /api/v1/runs HTTP/1.1\r\nHost: " + served.host() +
              "\r\nContent-Type: application/json\r\n" + Served::bearer(served.op) +
              "Transfer-Encoding: chunked\r\n\r\n");
    int sent_mb = 0;
    while (sent_mb < 300 && wire.send(block)) ++sent_mb;
    EXPECT_LT(sent_mb, 300);
  }
  expectSmall(growth);
}

TEST(Listener, HoldsNoMoreThanItsBudgetOfManyLargeBodies) {
  const Served served;
  served.ask("GET", "/");
  const Growth growth;
  std::vector<Wire> all;
  int refused = 0;
  for (int i = 0; i < 45; ++i) {
    all.push_back(Wire::tcp(served.server->port(), "127.0.0." + std::to_string(2 + i / 15)));
    all.back().send("POST /api/v1/runs HTTP/1.1\r\nHost: " + served.host() +
                    "\r\nContent-Type: application/json\r\n" + Served::bearer(served.op) +
                    "Content-Length: 1048576\r\nExpect: 100-continue\r\n\r\n");
    const int status = all.back().reply().status;
    refused += status == 503;
    if (status == 100) all.back().send(std::string((1 << 20) - 1, 'x'));
  }
  EXPECT_EQ(refused, 25);  // of 45 MiB, 20 have room
  expectSmall(growth);
}

TEST(Listener, AnswersARangeBombWithARefusal) {
  Served served({{"GET", "/object", Role::kViewer, "object", [](const Request&) {
                    Response response;
                    response.file = "large";
                    return response;
                  }}});
  testing::writeFile(served.folder / "large", std::string(8 << 20, 'x'));
  std::string ranges = "Range: bytes=0-";
  for (int i = 0; i < 1000; ++i) ranges += ",0-";
  const Growth growth;
  for (int i = 0; i < 50; ++i)
    EXPECT_EQ(served.ask("GET", "/object", Served::bearer(served.viewer) + ranges + "\r\n").status,
              416);
  const WireReply part =
      served.ask("GET", "/object", Served::bearer(served.viewer) + "Range: bytes=5-9\r\n");
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.body, "xxxxx");
  expectSmall(growth);
}

TEST(Listener, HangsUpOnAReaderThatIsTooSlow) {
  Served served({{"GET", "/object", Role::kViewer, "object", [](const Request&) {
                    Response response;
                    response.file = "large";
                    return response;
                  }}});
  constexpr std::size_t kBytes = 64 << 20;  // more than the kernel takes for us
  testing::writeFile(served.folder / "large", std::string(kBytes, 'x'));
  Wire slow = Wire::tcp(served.server->port());
  slow.send(served.request("GET", "/object", Served::bearer(served.viewer)));
  EXPECT_EQ(slow.line(), "HTTP/1.1 200 OK");
  served.clock.advance(seconds(30 + kBytes / (16 << 10) - 1));
  EXPECT_EQ(served.metric("patina_http_late_total"), 0);
  served.clock.advance(seconds(1));
  EXPECT_TRUE(slow.ended());
  waitFor(served, "patina_http_late_total", 1);
}

TEST(Listener, StaysSmallAndServesTheUnixSocketUnderTenThousandConnections) {
  constexpr rlim_t kDescriptors = 10'500;
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = std::min(limit.rlim_max, std::max(limit.rlim_cur, kDescriptors));
  setrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur < kDescriptors)
    GTEST_SKIP() << "needs " << kDescriptors << " descriptors: raise ulimit -n";
  const Served served;
  served.ask("GET", "/");
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(served.server->port()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const Growth growth;
  std::vector<devices::Descriptor> flood;
  for (int i = 0; i < 10'000; ++i) {
    flood.emplace_back(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    connect(flood.back().fd(), reinterpret_cast<sockaddr*>(&address), sizeof address);
    send(flood.back().fd(), "GET / HTTP/1.1\r\nX", 17, MSG_NOSIGNAL);
    if (i % 1000 == 0) {
      EXPECT_LE(served.metric("patina_http_connections"), 49);
    }
  }
  expectSmall(growth);
  flood.clear();
  EXPECT_EQ(served.local().ask(served.request("GET", "/api/v1/status")).status, 200);
}

TEST(Listener, StreamsEventsAndGoesOnAfterTheLastOne) {
  const Served served;
  Wire wire = Wire::tcp(served.server->port());
  const std::string fields = Served::bearer(served.viewer);
  EXPECT_EQ(wire.ask(served.request("GET", "/events", fields)).fields.at("content-type"),
            "text/event-stream");
  const auto next = [](Wire& from, const std::string& prefix) {
    for (std::string line = from.line();; line = from.line())
      if (line.starts_with(prefix)) return line.substr(prefix.size());
  };
  served.server->publish("step", "1");
  const std::string id = next(wire, "id: ");
  served.server->publish("step", "2");
  wire.hangUp();
  Wire again = Wire::tcp(served.server->port());
  again.ask(served.request("GET", "/events", fields + "Last-Event-ID: " + id + "\r\n"));
  EXPECT_EQ(next(again, "data: "), "2");
}

TEST(Listener, HasSixteenStreamsAndTakesBackThoseWhoseReaderIsGone) {
  Served served;
  std::vector<Wire> all;
  const auto open = [&](const std::string& from) {
    all.push_back(Wire::tcp(served.server->port(), from));
    return all.back().ask(served.request("GET", "/events", Served::bearer(served.viewer))).status;
  };
  for (int i = 0; i < 16; ++i) EXPECT_EQ(open(i < 8 ? "127.0.0.2" : "127.0.0.3"), 200) << i;
  EXPECT_EQ(open("127.0.0.4"), 503);
  all.front().hangUp();
  while (served.metric("patina_http_streams") == 16) served.clock.advance(seconds(1));
  EXPECT_EQ(open("127.0.0.4"), 200);
}

TEST(Listener, DropsAndCountsAStreamThatDoesNotRead) {
  const Served served;
  Wire slow = Wire::tcp(served.server->port());
  const int small = 4096;
  setsockopt(slow.fd(), SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
  EXPECT_EQ(slow.ask(served.request("GET", "/events", Served::bearer(served.viewer))).status, 200);
  const Growth growth;
  const std::string event(60'000, 'x');
  while (served.metric("patina_dropped_total{reason=\"event_stream\"}") < 1)
    served.server->publish("step", event);
  expectSmall(growth);
  waitFor(served, "patina_http_streams", 0);  // its place is free
}

}  // namespace
}  // namespace patina::http
