// SPDX-License-Identifier: GPL-3.0-or-later
// http_flood PORT TOKEN OBJECT: attacks a daemon's door until it is killed, in a process of its own
// so that what it takes is not the daemon's. A line a second says how often each attack was made.
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <system_error>
#include <thread>
#include <vector>

#include "devices/clock.h"
#include "tests/capture/app/http/wire.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using http::Wire;

constexpr int kCrowd = 10'000, kHeaderMegabytes = 300, kSlowOnes = 16;

// Each attack comes from an address of its own: the limit of one peer must not spare the others.
class Flood {
 public:
  Flood(int port, const std::string& token, std::string object)
      : port_(port),
        host_("Host: 127.0.0.1:" + std::to_string(port) + "\r\n"),
        bearer_("Authorization: Bearer " + token + "\r\n"),
        object_(std::move(object)) {}

  void run() {
    std::vector<std::thread> threads;
    for (const auto attack : {&Flood::slowHeaders, &Flood::crowd, &Flood::endlessHeader,
                              &Flood::chunkedBomb, &Flood::rangeBomb})
      threads.emplace_back([this, attack] { overAndOver(attack); });
    while (true) {
      pause(1s);
      std::printf(
          "%d slow headers, %d connections, %d endless headers, %d chunked bombs, "
          "%d range bombs\n",
          slow_.load(), crowd_.load(), headers_.load(), chunked_.load(), ranges_.load());
      std::fflush(stdout);
    }
  }

 private:
  void pause(Nanoseconds time) { clock_.sleepUntil(clock_.mono() + time, {}); }
  void overAndOver(void (Flood::*attack)()) {
    while (true) {
      try {
        (this->*attack)();
      } catch (const std::system_error&) {
        pause(10ms);  // no port or descriptor was free
      }
    }
  }

  void slowHeaders() {
    std::vector<Wire> all;
    for (int i = 0; i < kSlowOnes; ++i) {
      all.push_back(Wire::tcp(port_, "127.0.1.1"));
      all.back().send("GET / HTTP/1.1\r\n" + host_ + "X: ");
      ++slow_;
    }
    // A byte now and then, for longer than the door waits.
    for (int i = 0; i < 60; ++i) {
      pause(100ms);
      for (Wire& wire : all) wire.send("x");
    }
  }

  // Opened at once, held for a while, reset.
  void crowd() {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port_));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    std::vector<devices::Descriptor> all;
    for (int i = 0; i < kCrowd; ++i) {
      all.emplace_back(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
      const linger reset{1, 0};
      setsockopt(all.back().fd(), SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
      sockaddr_in from{};
      from.sin_family = AF_INET;
      from.sin_addr.s_addr = htonl(INADDR_LOOPBACK + 0x200 + static_cast<std::uint32_t>(i % 50));
      if (bind(all.back().fd(), reinterpret_cast<const sockaddr*>(&from), sizeof from) != 0)
        continue;
      // Not waited for.
      static_cast<void>(
          connect(all.back().fd(), reinterpret_cast<const sockaddr*>(&to), sizeof to));
      send(all.back().fd(), "GET / HTTP/1.1\r\nX", 17, MSG_NOSIGNAL);
      ++crowd_;
    }
    pause(2s);
    all.clear();
    pause(4s);  // in which the other attacks get in
  }

  void sendUntilHungUp(Wire& wire, const std::string& block) {
    for (int sent = 0; sent < kHeaderMegabytes && wire.send(block); ++sent) continue;
  }

  void endlessHeader() {
    static const std::string kBlock(1 << 20, 'x');
    Wire wire = Wire::tcp(port_, "127.0.3.1");
    wire.send("GET / HTTP/1.1\r\n" + host_ + "X: ");
    sendUntilHungUp(wire, kBlock);
    ++headers_;
  }

  void chunkedBomb() {
    static const std::string kBlock = "100000\r\n" + std::string(1 << 20, 'x') + "\r\n";
    Wire wire = Wire::tcp(port_, "127.0.4.1");
    wire.send("POST /api/v1/runs HTTP/1.1\r\n" + host_ + bearer_ +
              "Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n");
    sendUntilHungUp(wire, kBlock);
    ++chunked_;
  }

  // A thousand ranges, and then the honest requests that cost most.
  void rangeBomb() {
    static const std::string kRanges = [] {
      std::string text = "Range: bytes=0-";
      for (int i = 0; i < 1000; ++i) text += ",0-";
      return text + "\r\n";
    }();
    Wire wire = Wire::tcp(port_, "127.0.5.1");
    wire.ask("GET /api/v1/objects/" + object_ + " HTTP/1.1\r\n" + host_ + bearer_ + kRanges +
             "\r\n");
    wire.ask("GET /api/v1/objects/" + object_ + "/preview HTTP/1.1\r\n" + host_ + bearer_ + "\r\n");
    wire.ask("GET /metrics HTTP/1.1\r\n" + host_ + bearer_ + "\r\n");
    ++ranges_;
  }

  devices::RealClock clock_;
  int port_;
  std::string host_, bearer_, object_;
  std::atomic<int> slow_{0}, crowd_{0}, headers_{0}, chunked_{0}, ranges_{0};
};

}  // namespace
}  // namespace patina::testing

int main(int count, char** words) {
  if (count != 4) {
    std::fprintf(stderr, "usage: http_flood PORT TOKEN OBJECT\n");
    return 64;
  }
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
  patina::testing::Flood(std::atoi(words[1]), words[2], words[3]).run();
}
