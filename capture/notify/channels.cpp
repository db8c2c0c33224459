// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/channels.h"

#include "capture/notify/email.h"
#include "capture/notify/heartbeat.h"
#include "capture/notify/webhook.h"

namespace patina::capture::notify {
namespace {

// A channel is no reason for a rig to stand still: the week is worth more than its alarms.
template <class Make>
void open(Channels& into, const std::string& name, Make make) {
  try {
    into.open.push_back(make());
  } catch (const NotifyError& error) {
    into.problems.push_back(name + ": " + error.what());
  }
}

}  // namespace

Channels openChannels(const AlertSettings& settings, const About& about, const Inventory& inventory,
                      Mqtt::Purpose purpose, const std::filesystem::path& sendmail) {
  Channels channels;
  if (settings.heartbeat)
    open(channels, "heartbeat", [&] { return std::make_unique<Heartbeat>(*settings.heartbeat); });
  for (const WebhookSettings& webhook : settings.webhooks)
    open(channels, "webhook", [&] { return std::make_unique<Webhook>(webhook); });
  if (settings.email)
    open(channels, "email", [&] { return std::make_unique<Email>(*settings.email, sendmail); });
  if (settings.mqtt)
    open(channels, "mqtt",
         [&] { return std::make_unique<Mqtt>(*settings.mqtt, about, inventory, purpose); });
  return channels;
}

}  // namespace patina::capture::notify
