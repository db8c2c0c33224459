// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/alert_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace patina::capture {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

AlertSettings read(const std::string& toml) {
  devices::ConfigTable root = devices::ConfigFile::parse(toml, "/plans/week.toml");
  AlertSettings settings = takeAlerts(root, 10min);
  root.finish();
  return settings;
}

std::string problem(const std::string& toml) {
  try {
    read(toml);
  } catch (const devices::ConfigError& error) {
    EXPECT_EQ(error.exit(), Exit::kConfig);
    return error.what();
  }
  return "no error";
}

const AlertRule& rule(const AlertSettings& settings, AlertKind kind) {
  return settings.rules[static_cast<std::size_t>(kind)];
}

TEST(AlertSettings, AreTheDefaultsWithoutASection) {
  const AlertSettings settings = read("");
  EXPECT_FALSE(settings.anyChannel());
  EXPECT_EQ(rule(settings, AlertKind::kCameraDown).onset, 5min);
}

TEST(AlertSettings, ReadEveryKey) {
  const AlertSettings settings = read(R"(
[[alerts.webhook]]
url = "https://hooks.example.org/x"
token_file = "secrets/token"
least = "critical"
[[alerts.webhook]]
url_file = "/etc/patina/hook"
[alerts.email]
to = ["lab@example.org", "a.b+c@x.org"]
from = "rig@example.org"
least = "info"
[alerts.mqtt]
host = "broker"
tls = true
user = "rig"
password_file = "secrets/mqtt"
ca_file = "ca.pem"
topic = "lab/patina"
discovery = ""
[alerts.heartbeat]
url = "https://hc.example.org/1234"
[alerts.camera_down]
onset = "2min"
recovery = "1h"
severity = "warning"
reminders = ["30min", "7d"]
)");
  EXPECT_TRUE(settings.anyChannel());
  ASSERT_EQ(settings.webhooks.size(), 2u);
  EXPECT_EQ(settings.webhooks[0].token_file, "/plans/secrets/token");
  EXPECT_EQ(settings.webhooks[0].least, Severity::kCritical);
  EXPECT_EQ(settings.webhooks[1].url_file, "/etc/patina/hook");
  EXPECT_THAT(settings.email->to, ElementsAre("lab@example.org", "a.b+c@x.org"));
  EXPECT_EQ(settings.email->least, Severity::kInfo);
  EXPECT_EQ(settings.mqtt->port, 8883);
  EXPECT_EQ(settings.mqtt->password_file, "/plans/secrets/mqtt");
  EXPECT_EQ(settings.mqtt->topic, "lab/patina");
  EXPECT_EQ(settings.mqtt->discovery, "");
  EXPECT_EQ(settings.heartbeat->url, "https://hc.example.org/1234");
  const AlertRule& down = rule(settings, AlertKind::kCameraDown);
  EXPECT_EQ(down.onset, 2min);
  EXPECT_EQ(down.recovery, 1h);
  EXPECT_EQ(down.severity, Severity::kWarning);
  EXPECT_THAT(down.reminders, ElementsAre(30min, 168h));
  EXPECT_EQ(rule(settings, AlertKind::kLampDead).onset, 1min);
}

TEST(AlertSettings, RefuseWhatCannotBe) {
  EXPECT_THAT(problem("[alerts.camara_down]\n"), HasSubstr("camera_down"));
  EXPECT_THAT(problem("[alerts.camera_down]\nonset = \"5\"\n"), HasSubstr("onset"));
  EXPECT_THAT(problem("[alerts.camera_down]\nreminders = [\"1s\"]\n"), HasSubstr("out of range"));
  EXPECT_THAT(problem("[alerts.camera_down]\nseverity = \"loud\"\n"), HasSubstr("critical"));
  EXPECT_THAT(problem("[[alerts.webhook]]\n"), HasSubstr("name url or url_file"));
  EXPECT_THAT(problem("[[alerts.webhook]]\nurl = \"ftp://x/y\"\n"), HasSubstr("https://"));
  EXPECT_THAT(problem("[[alerts.webhook]]\nurl = \"file:///etc/passwd\"\n"), HasSubstr("https://"));
  EXPECT_THAT(problem("[[alerts.webhook]]\nurl = \"https://x\"\nurl_file = \"y\"\n"),
              HasSubstr("exclude"));
  EXPECT_THAT(problem("[[alerts.webhook]]\nurl = \"https://x\"\ncommand = \"rm\"\n"),
              HasSubstr("command"));
  EXPECT_THAT(problem("[alerts.mqtt]\npassword_file = \"x\"\n"), HasSubstr("needs a user"));
  EXPECT_THAT(problem("[alerts.mqtt]\ntopic = \"a/#\"\n"), HasSubstr("topic"));
  EXPECT_THAT(problem("[alerts.mqtt]\nhost = \"a b\"\n"), HasSubstr("host"));
}

TEST(AlertSettings, RefuseAddressesThatWouldAddAHeaderOrAnOption) {
  for (const char* address : {R"(a@b\nBcc: c@d)", R"(a@b\r\nX: y)", "a@b, c@d", "-oQ/tmp@b",
                              "a b@c", "<a@b>", "a@-b", "@b", "a@", "a@b;id", "|/bin/sh@b"})
    EXPECT_THAT(problem("[alerts.email]\nto = [\"" + std::string(address) + "\"]\n"),
                HasSubstr("no address"))
        << address;
  EXPECT_THAT(problem("[alerts.email]\nto = [\"a@b\"]\nfrom = \"a@b\\nBcc: c@d\"\n"),
              HasSubstr("no address"));
}

TEST(AlertSettings, RefusePasswordsInAnAddressWithoutRepeatingThem) {
  const std::string said = problem("[[alerts.webhook]]\nurl = \"https://me:hunter2@x/y\"\n");
  EXPECT_THAT(said, HasSubstr("url_file"));
  EXPECT_THAT(said, Not(HasSubstr("hunter2")));
}

}  // namespace
}  // namespace patina::capture
