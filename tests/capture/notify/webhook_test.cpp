// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/webhook.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/capture/notify/messages.h"
#include "tests/capture/notify/receiver.h"
#include "tests/support/temp_folder.h"

namespace patina::capture::notify {
namespace {

using patina::testing::Receiver;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Webhook, PostsTheMessage) {
  Receiver receiver;
  WebhookSettings settings;
  settings.url = receiver.url();
  Webhook webhook(settings);
  EXPECT_TRUE(webhook.send(cameraDown(), {}).delivered());
  EXPECT_EQ(receiver.requests().at(0).body, jsonOf(cameraDown()));
}

TEST(Webhook, WantsWhatIsBadEnoughAndEveryTest) {
  WebhookSettings settings;
  settings.url = "http://host/";
  const Webhook webhook(settings);
  EXPECT_TRUE(webhook.wants(cameraDown()));
  EXPECT_TRUE(webhook.wants(over()));
  EXPECT_TRUE(webhook.wants(test()));
  EXPECT_FALSE(webhook.wants(run("the run begins")));
  EXPECT_FALSE(webhook.wants(frame()));
  EXPECT_FALSE(webhook.wants(status(1)));
  settings.least = Severity::kInfo;
  EXPECT_TRUE(Webhook(settings).wants(run("the run begins")));
}

TEST(Webhook, KeepsItsSecretsOutOfItsNameAndAnswers) {
  const auto folder = patina::testing::TempFolder::inMemory();
  Receiver receiver(Receiver::status(401));
  patina::testing::writeFile(folder / "url", receiver.url("/hunter2") + "\n");
  patina::testing::writeFile(folder / "token", "hunter3\n");
  chmod((folder / "url").c_str(), 0600);
  chmod((folder / "token").c_str(), 0600);
  WebhookSettings settings;
  settings.url_file = folder / "url";
  settings.token_file = folder / "token";
  Webhook webhook(settings);
  const Delivery delivery = webhook.send(cameraDown(), {});
  EXPECT_EQ(receiver.requests().at(0).line, "POST /hunter2 HTTP/1.1");
  EXPECT_THAT(receiver.requests().at(0).head, HasSubstr("Bearer hunter3"));
  EXPECT_THAT(webhook.name() + delivery.answer, Not(HasSubstr("hunter")));
}

TEST(Webhook, IsNotMadeWithoutItsSecret) {
  WebhookSettings settings;
  settings.url_file = "/nowhere/at/all";
  EXPECT_THROW(Webhook{settings}, NotifyError);
}

}  // namespace
}  // namespace patina::capture::notify
