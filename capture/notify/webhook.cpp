// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/webhook.h"

#include "capture/notify/http_call.h"
#include "capture/notify/secret_file.h"

namespace patina::capture::notify {

Webhook::Webhook(const WebhookSettings& settings)
    : url_(settings.url_file ? readSecret(*settings.url_file) : settings.url),
      token_(settings.token_file ? readSecret(*settings.token_file) : std::string()),
      name_("webhook " + hostOf(url_)),
      least_(settings.least) {}

bool Webhook::wants(const Message& message) const { return isForPeople(message, least_); }

Delivery Webhook::send(const Message& message, const std::stop_token& hurry) {
  HttpCall request;
  request.url = url_;
  request.body = jsonOf(message);
  request.token = token_;
  return call(request, hurry);
}

}  // namespace patina::capture::notify
