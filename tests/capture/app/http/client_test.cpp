// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/client.h"

#include <gtest/gtest.h>

#include "tests/capture/app/http/served.h"

namespace patina::http {
namespace {

TEST(Client, AsksAsAdminThroughTheUnixSocket) {
  const Served served;
  Client client(served.options.socket);
  const Reply status = client.call("GET", "/api/v1/status");
  EXPECT_EQ(status.status, 200);
  EXPECT_EQ(status.content_type, "application/json");
  EXPECT_EQ(client.call("POST", "/api/v1/reload").status, 200);
  EXPECT_EQ(client.call("POST", "/api/v1/runs", std::string(100'000, ' ')).body,
            "{\"did\":\"startRun\",\"body_bytes\":100000}");
  EXPECT_EQ(client.call("GET", "/api/v1/../status").status, 404);
  EXPECT_EQ(client.call("DELETE", "/api/v1/tokens/v").status, 200);
}

TEST(Client, SaysThatNoDaemonListens) {
  const auto folder = testing::TempFolder::inMemory();
  Client client(folder / "nobody");
  try {
    client.call("GET", "/api/v1/status");
    FAIL() << "no daemon, no answer";
  } catch (const HttpError& error) {
    EXPECT_EQ(error.exit(), Exit::kUnavailable);
    EXPECT_NE(std::string(error.what()).find("patina daemon"), std::string::npos);
  }
}

TEST(Client, HearsEventsUntilItIsToldToStop) {
  const Served served;
  Client client(served.options.socket);
  std::stop_source stop;
  std::vector<std::string> heard;
  std::jthread teller([&served](const std::stop_token& done) {
    while (!done.stop_requested() && served.metric("patina_http_streams") < 1) continue;
    for (int i = 0; i < 3; ++i) served.server->publish("step", std::to_string(i));
  });
  client.events(
      [&](const Event& event) {
        heard.push_back(event.data);
        if (heard.size() == 3) stop.request_stop();
      },
      stop.get_token());
  EXPECT_EQ(heard, (std::vector<std::string>{"0", "1", "2"}));
}

TEST(Client, PassesOnWhatItsCallThrows) {
  const Served served;
  served.server->publish("step", "1");
  Client client(served.options.socket);
  std::jthread teller([&served](const std::stop_token& done) {
    while (!done.stop_requested() && served.metric("patina_http_streams") < 1) continue;
    served.server->publish("step", "2");
  });
  EXPECT_THROW(client.events([](const Event&) { throw std::runtime_error("mine"); }, {}),
               std::runtime_error);
}

}  // namespace
}  // namespace patina::http
