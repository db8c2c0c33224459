// SPDX-License-Identifier: GPL-3.0-or-later
// patina alerts, and what patina capture tells: against receivers of our own.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <csignal>

#include "tests/capture/app/ack_pipe.h"
#include "tests/capture/app/rehearsed.h"
#include "tests/capture/notify/broker.h"
#include "tests/capture/notify/receiver.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class AlertsVerb : public ::testing::Test {
 protected:
  std::string plan(const std::string& alerts) {
    const std::string file = changedPlan(files_, {{"[\"ttf\", \"film\"]", "[]"}});
    writeFile(file, readFile(file) + alerts);
    return file;
  }
  std::string webhook(const Receiver& receiver, const std::string& more = {}) {
    return "[[alerts.webhook]]\nurl = \"" + receiver.url() + "\"\n" + more;
  }
  std::vector<std::string> capture(const std::string& plan) {
    return {program(), "capture", plan,         "--archive", folder_ / "a",
            "--json",  "--quiet", "--log-acks", pipe_.path()};
  }
  TempFolder files_ = TempFolder::inMemory(), folder_ = TempFolder::inMemory();
  AckPipe pipe_{folder_ / "acks"};
};

TEST_F(AlertsVerb, SendsOneMessageThroughEveryChannelAndSaysWhatEachAnswered) {
  Receiver good, bad(Receiver::status(403));
  const std::string sendmail = folder_ / "sendmail";
  writeFile(sendmail, "#!/bin/sh\ncat >" + (folder_ / "mail").string() + "\n");
  chmod(sendmail.c_str(), 0700);
  const std::string file =
      plan(webhook(good) + webhook(bad) + "[alerts.email]\nto = [\"lab@example.org\"]\n");
  const Finished done = runPatina({"alerts", "test", file, "--json", "--sendmail", sendmail});
  EXPECT_EQ(done.exit, 69);
  const JsonAnswer answer(done.out);
  ASSERT_EQ(answer.size("/items"), 3u) << done.out << done.err;
  EXPECT_EQ(answer.text("/items/0/answer"), "HTTP 204");
  EXPECT_EQ(answer.text("/items/1/answer"), "HTTP 403");
  EXPECT_EQ(answer.text("/items/2/channel"), "email lab@example.org");
  EXPECT_THAT(good.requests().at(0).body, HasSubstr("\"kind\":\"test\""));
  EXPECT_THAT(readFile(folder_ / "mail"), HasSubstr("Subject: [info] copper: test message"));
}

TEST_F(AlertsVerb, EndsWellWhenEveryChannelWorks) {
  Receiver good;
  EXPECT_EQ(runPatina({"alerts", "test", plan(webhook(good))}).exit, 0);
}

TEST_F(AlertsVerb, SaysWhatIsMissing) {
  const Finished none = runPatina({"alerts", "test", plan("")});
  EXPECT_EQ(none.exit, 78);
  EXPECT_THAT(none.err, HasSubstr("names no channel"));
  const Finished secret =
      runPatina({"alerts", "test", plan("[alerts.heartbeat]\nurl_file = \"none\"\n")});
  EXPECT_EQ(secret.exit, 69);
  EXPECT_THAT(secret.out, HasSubstr("none cannot be read"));
}

TEST_F(AlertsVerb, ShowsTheExampleAsAPlanThatCanBeChecked) {
  const Finished done = runPatina({"plan", "check", sourceFolder() / "examples/alerts/plan.toml"});
  EXPECT_EQ(done.exit, 0) << done.err;
}

TEST_F(AlertsVerb, CaptureTellsItsBeginningItsFramesAndItsEnd) {
  Receiver hook, beat;
  Child child(capture(plan(webhook(hook, "least = \"info\"\n") + "[alerts.heartbeat]\nurl = \"" +
                           beat.url("/beat") + "\"\n")));
  pipe_.line();
  EXPECT_EQ(beat.waitForRequests(1).at(0).line, "GET /beat HTTP/1.1");
  EXPECT_THAT(hook.waitForRequests(1).at(0).body, HasSubstr("the run begins"));
  child.signal(SIGTERM);
  answerOf(child.wait());
  EXPECT_THAT(hook.requests().back().body, HasSubstr("the run stopped: 1 of 12 steps captured"));
}

TEST_F(AlertsVerb, CaptureGoesOnWhenNobodyListens) {
  Receiver hanging("");
  const std::string gone = "http://127.0.0.1:" + std::to_string(freePort()) + "/";
  Child child(
      capture(plan(webhook(hanging, "least = \"info\"\n") + "[[alerts.webhook]]\nurl = \"" + gone +
                   "\"\nleast = \"info\"\n" + "[[alerts.webhook]]\nurl_file = \"none\"\n")));
  EXPECT_THAT(pipe_.line(), ::testing::StartsWith("ack "));
  child.signal(SIGTERM);
  const Finished done = child.wait();
  EXPECT_EQ(answerOf(done).text("/items/0/end"), "stopped");
}

TEST_F(AlertsVerb, TheBrokerTellsThatAKilledCaptureIsOffline) {
  PATINA_BROKER_OR_SKIP();
  Broker broker;
  Listener listener(broker.settings());
  Child child(capture(plan("[alerts.mqtt]\nhost = \"127.0.0.1\"\nport = " +
                           std::to_string(broker.settings().port) + "\n")));
  listener.waitFor("patina/copper/status", "online");
  listener.waitFor("patina/copper/camera/cam0", "ok");
  pipe_.line();
  child.signal(SIGKILL);
  child.wait();
  listener.waitFor("patina/copper/status", "offline");
}

TEST_F(AlertsVerb, ARehearsalRousesNobodyAndCountsWhatItWouldHaveTold) {
  Receiver hook, beat;
  const std::string file = plan(webhook(hook, "least = \"info\"\n") +
                                "[alerts.heartbeat]\nurl = \"" + beat.url() + "\"\n");
  const JsonAnswer answer =
      answerOf(runPatina({"rehearse", file, "--archive", folder_ / "a", "--json"}));
  EXPECT_EQ(answer.number("/items/0/alerts"), 0);
  EXPECT_TRUE(hook.requests().empty());
  EXPECT_TRUE(beat.requests().empty());
}

}  // namespace
}  // namespace patina::testing
