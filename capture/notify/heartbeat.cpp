// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/heartbeat.h"

#include "capture/notify/http_call.h"
#include "capture/notify/secret_file.h"

namespace patina::capture::notify {

Heartbeat::Heartbeat(const HeartbeatSettings& settings)
    : url_(settings.url_file ? readSecret(*settings.url_file) : settings.url),
      name_("heartbeat " + hostOf(url_)) {}

bool Heartbeat::wants(const Message& message) const {
  return message.kind == MessageKind::kFrame || message.kind == MessageKind::kTest;
}

Delivery Heartbeat::send(const Message&, const std::stop_token& hurry) {
  HttpCall request;
  request.url = url_;
  return call(request, hurry);
}

}  // namespace patina::capture::notify
