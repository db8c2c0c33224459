// SPDX-License-Identifier: GPL-3.0-or-later
// From a handler's Response to what libmicrohttpd sends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "capture/app/http/byte_budget.h"
#include "capture/app/http/gate.h"
#include "capture/app/http/messages.h"
#include "devices/descriptor.h"

struct MHD_Response;

namespace patina::http {

// What every answer carries: content policy, no sniffing, no referrer, no other origin, no cache.
const std::map<std::string, std::string>& protectiveHeaders();

struct Answer {
  MHD_Response* response = nullptr;  // to be queued and destroyed by the caller
  int status = 0;
  std::uint64_t bytes = 0;  // that the client is to read
};

// Thread-safe. The budget must outlive every answer.
class AnswerMaker {
 public:
  AnswerMaker(const std::filesystem::path& archive, ByteBudget& budget);

  // Takes care of Range and If-None-Match. A file outside the archive, or one that is no regular
  // file, is a 500; an answer the budget has no room for a 503.
  Answer make(const Admission& admission, Response response) const;

 private:
  Answer fromBody(Response response) const;
  Answer fromFile(const Admission& admission, Response response) const;
  devices::Descriptor openBeneath(const std::filesystem::path& file) const;

  std::filesystem::path archive_;
  devices::Descriptor root_;  // -1: no files
  ByteBudget& budget_;
};

// Adds protectiveHeaders() and the response's own, which win.
void addHeaders(MHD_Response* to, const Response& response);

}  // namespace patina::http
