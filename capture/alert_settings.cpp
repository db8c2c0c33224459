// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/alert_settings.h"

#include <algorithm>

namespace patina::capture {
namespace {

using devices::ConfigTable;
using namespace std::chrono_literals;

constexpr Nanoseconds kDelayMost = 24h * 30, kReminderLeast = 1min;
constexpr std::size_t kRecipientsMost = 20, kWebhooksMost = 10, kUrlBytesMost = 2000;

bool isLetterOrDigit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

bool onlyOf(const std::string& text, const char* besides) {
  return std::all_of(text.begin(), text.end(), [&](char c) {
    return isLetterOrDigit(c) ||
           (c != '\0' && std::string_view(besides).find(c) != std::string::npos);
  });
}

Severity takeSeverity(ConfigTable& table, const std::string& key, Severity fallback) {
  const std::string text = table.takeChoice(key, {"info", "warning", "critical"}, name(fallback));
  return text == "info"      ? Severity::kInfo
         : text == "warning" ? Severity::kWarning
                             : Severity::kCritical;
}

SecretFile takeFile(ConfigTable& table, const std::string& key) {
  if (!table.has(key)) return std::nullopt;
  return table.takePath(key);
}

// The messages never repeat the text: it may hold what the writer did not mean to show.
std::string takeUrl(ConfigTable& table, const SecretFile& url_file) {
  std::string url = table.takeString("url", "");
  if (url.empty() && !url_file) table.reject("url", "is missing; name url or url_file");
  if (!url.empty() && url_file) table.reject("url", "and url_file exclude each other");
  if (url.empty()) return url;
  const bool http = url.starts_with("http://"), https = url.starts_with("https://");
  const std::size_t begin = http ? 7 : 8;
  if ((!http && !https) || url.size() <= begin || url.size() > kUrlBytesMost ||
      std::any_of(url.begin(), url.end(), [](char c) { return c <= ' ' || c > '~'; }))
    table.reject("url", "is no address such as https://host/path");
  if (url.substr(begin, url.find('/', begin) - begin).find('@') != std::string::npos)
    table.reject("url",
                 "holds a user or password; put the whole address into url_file, which "
                 "stays out of the archive");
  return url;
}

bool isAddress(const std::string& text) {
  const std::size_t at = text.find('@');
  if (at == std::string::npos || at == 0 || at + 1 == text.size() || text.size() > 254)
    return false;
  const std::string user = text.substr(0, at), host = text.substr(at + 1);
  return user[0] != '-' && onlyOf(user, "._%+-") && host[0] != '-' && onlyOf(host, ".-");
}

void requireAddress(const ConfigTable& table, const std::string& key, const std::string& text) {
  if (!isAddress(text)) table.reject(key, "\"" + text + "\" is no address such as name@host");
}

WebhookSettings takeWebhook(ConfigTable& table) {
  WebhookSettings settings;
  settings.url_file = takeFile(table, "url_file");
  settings.url = takeUrl(table, settings.url_file);
  settings.token_file = takeFile(table, "token_file");
  settings.least = takeSeverity(table, "least", settings.least);
  table.finish();
  return settings;
}

EmailSettings takeEmail(ConfigTable& table) {
  EmailSettings settings;
  settings.to = table.takeStrings("to");
  if (settings.to.empty() || settings.to.size() > kRecipientsMost)
    table.reject("to", "must name 1 to " + std::to_string(kRecipientsMost) + " addresses");
  for (const std::string& to : settings.to) requireAddress(table, "to", to);
  settings.from = table.takeString("from", "");
  if (!settings.from.empty()) requireAddress(table, "from", settings.from);
  settings.least = takeSeverity(table, "least", settings.least);
  table.finish();
  return settings;
}

MqttSettings takeMqtt(ConfigTable& table) {
  MqttSettings settings;
  settings.host = table.takeString("host", settings.host);
  if (settings.host.empty() || settings.host.size() > 253 || !onlyOf(settings.host, ".-:"))
    table.reject("host", "must be a name or an address");
  settings.tls = table.takeBool("tls", false);
  settings.port = static_cast<int>(table.takeInteger("port", 1, 65535, settings.tls ? 8883 : 1883));
  settings.user = table.takeString("user", "");
  settings.password_file = takeFile(table, "password_file");
  settings.ca_file = takeFile(table, "ca_file");
  settings.topic = table.takeString("topic", settings.topic);
  settings.discovery = table.takeString("discovery", settings.discovery);
  if (settings.topic.empty() || settings.topic.size() > 200 || !onlyOf(settings.topic, "_-/"))
    table.reject("topic", "must be letters, digits, _, - and / (1 to 200 of them)");
  if (settings.discovery.size() > 200 || !onlyOf(settings.discovery, "_-/"))
    table.reject("discovery", "must be letters, digits, _, - and / (at most 200), or empty");
  if (settings.password_file && settings.user.empty())
    table.reject("password_file", "needs a user");
  if (settings.ca_file && !settings.tls) table.reject("ca_file", "needs tls = true");
  table.finish();
  return settings;
}

HeartbeatSettings takeHeartbeat(ConfigTable& table) {
  HeartbeatSettings settings;
  settings.url_file = takeFile(table, "url_file");
  settings.url = takeUrl(table, settings.url_file);
  table.finish();
  return settings;
}

std::vector<Nanoseconds> takeReminders(ConfigTable& table,
                                       const std::vector<Nanoseconds>& fallback) {
  if (!table.has("reminders")) return fallback;
  std::vector<Nanoseconds> reminders;
  for (const std::string& text : table.takeStrings("reminders")) {
    try {
      reminders.push_back(parseDuration(text));
    } catch (const ProcessingError& failure) {
      table.reject("reminders", failure.what());
    }
    if (reminders.back() < kReminderLeast || reminders.back() > kDelayMost)
      table.reject("reminders", text + " is out of range (" + formatDuration(kReminderLeast) +
                                    " to " + formatDuration(kDelayMost) + ")");
  }
  return reminders;
}

void takeRule(ConfigTable& table, AlertRule& rule) {
  rule.severity = takeSeverity(table, "severity", rule.severity);
  rule.onset = table.takeDuration("onset", 0ns, kDelayMost, rule.onset);
  rule.recovery = table.takeDuration("recovery", 0ns, kDelayMost, rule.recovery);
  rule.reminders = takeReminders(table, rule.reminders);
  table.finish();
}

}  // namespace

AlertSettings takeAlerts(ConfigTable& plan, Nanoseconds interval) {
  AlertSettings settings;
  settings.rules = defaultAlertRules(interval);
  auto alerts = plan.takeTable("alerts");
  if (!alerts) return settings;
  for (ConfigTable& table : alerts->takeTables("webhook"))
    settings.webhooks.push_back(takeWebhook(table));
  if (settings.webhooks.size() > kWebhooksMost)
    alerts->reject("webhook", "at most " + std::to_string(kWebhooksMost) + " webhooks");
  if (auto table = alerts->takeTable("email")) settings.email = takeEmail(*table);
  if (auto table = alerts->takeTable("mqtt")) settings.mqtt = takeMqtt(*table);
  if (auto table = alerts->takeTable("heartbeat")) settings.heartbeat = takeHeartbeat(*table);
  for (int i = 0; i < kAlertKindCount; ++i)
    if (auto table = alerts->takeTable(name(static_cast<AlertKind>(i))))
      takeRule(*table, settings.rules[static_cast<std::size_t>(i)]);
  alerts->finish();
  return settings;
}

}  // namespace patina::capture
