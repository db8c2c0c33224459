// SPDX-License-Identifier: GPL-3.0-or-later
// One picture by HTTP, with a limit on everything. A redirect is followed on the same host only,
// three times at most; certificates are checked; no proxy is asked.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "devices/clock.h"
#include "devices/result.h"
#include "processing/image/picture_file.h"

namespace patina::devices::network {

struct HttpGet {
  std::string who;  // begins every message
  std::string url;
  std::string credentials;  // "user:password" for basic or digest; empty: none
  std::string ca_file;      // empty: the system's
  std::uint64_t bytes_max = 0;
  Nanoseconds connect_limit{};
};

struct HttpReply {
  Bytes body;
  std::string content_type;
  // As the server says them, whole seconds of its own clock.
  std::optional<UtcTime> date, last_modified;
  Nanoseconds age{};          // in a cache
  MonoTime sent, first_byte;  // of the last request
};

// Only a good answer is a reply. kLost: nobody there; kTimeout: not by the deadline; kBusy: 429 and
// 5xx; kRefused: other answers, redirects off the host, certificates; kCorrupt: too long or cut.
Result<HttpReply> httpGet(const HttpGet& get, Clock& clock, MonoTime deadline);

}  // namespace patina::devices::network
