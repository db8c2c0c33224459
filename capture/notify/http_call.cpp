// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/http_call.h"

#include <curl/curl.h>

#include <memory>

namespace patina::capture::notify {
namespace {

constexpr std::size_t kAnswerBytesMost = 64 * 1024;

struct Reading {
  const std::stop_token* hurry = nullptr;
  std::size_t bytes = 0;
};

// The answer's body is nobody's business; one without end is not waited for.
std::size_t discard(char*, std::size_t size, std::size_t count, void* user) {
  auto& reading = *static_cast<Reading*>(user);
  reading.bytes += size * count;
  return reading.bytes > kAnswerBytesMost ? 0 : size * count;
}

int goOn(void* user, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return static_cast<Reading*>(user)->hurry->stop_requested() ? 1 : 0;
}

struct FreeEasy {
  void operator()(CURL* easy) const { curl_easy_cleanup(easy); }
};
struct FreeList {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};
using Easy = std::unique_ptr<CURL, FreeEasy>;
using List = std::unique_ptr<curl_slist, FreeList>;

void add(List& list, const std::string& line) {
  list.reset(curl_slist_append(list.release(), line.c_str()));
}

void prepare(CURL* easy, const HttpCall& request, Reading& reading) {
  curl_easy_setopt(easy, CURLOPT_URL, request.url.c_str());
  curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 0L);
  curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(easy, CURLOPT_TIMEOUT_MS, static_cast<long>(request.limit.count() / 1'000'000));
  curl_easy_setopt(easy, CURLOPT_USERAGENT, "patina");
  curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, discard);
  curl_easy_setopt(easy, CURLOPT_WRITEDATA, &reading);
  curl_easy_setopt(easy, CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(easy, CURLOPT_XFERINFOFUNCTION, goOn);
  curl_easy_setopt(easy, CURLOPT_XFERINFODATA, &reading);
  if (request.body.empty()) return;
  curl_easy_setopt(easy, CURLOPT_POST, 1L);
  curl_easy_setopt(easy, CURLOPT_POSTFIELDS, request.body.c_str());
  curl_easy_setopt(easy, CURLOPT_POSTFIELDSIZE, static_cast<long>(request.body.size()));
}

Delivery judge(long status) {
  const std::string answer = "HTTP " + std::to_string(status);
  if (status >= 200 && status < 300) return {Delivery::Result::kDelivered, answer};
  if (status >= 300 && status < 400)
    return {Delivery::Result::kRefused,
            answer + ": redirects are not followed; name the final address"};
  if (status == 408 || status == 425 || status == 429 || status >= 500)
    return {Delivery::Result::kTryAgain, answer};
  return {Delivery::Result::kRefused, answer};
}

}  // namespace

Delivery call(const HttpCall& request, const std::stop_token& hurry) {
  static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
  const Easy easy(ready == CURLE_OK ? curl_easy_init() : nullptr);
  if (!easy) return {Delivery::Result::kTryAgain, "out of memory"};
  Reading reading{&hurry, 0};
  prepare(easy.get(), request, reading);
  List headers;
  if (!request.body.empty()) add(headers, "Content-Type: application/json");
  add(headers, "Expect:");  // no waiting for "100 Continue"
  if (!request.token.empty()) add(headers, "Authorization: Bearer " + request.token);
  curl_easy_setopt(easy.get(), CURLOPT_HTTPHEADER, headers.get());

  const CURLcode code = curl_easy_perform(easy.get());
  long status = 0;
  curl_easy_getinfo(easy.get(), CURLINFO_RESPONSE_CODE, &status);
  // An answer that was cut short has said what it had to say.
  if (code == CURLE_OK || (code == CURLE_WRITE_ERROR && status != 0)) return judge(status);
  if (code == CURLE_OPERATION_TIMEDOUT)
    return {Delivery::Result::kTryAgain, "no answer within " + formatDuration(request.limit)};
  if (code == CURLE_ABORTED_BY_CALLBACK)
    return {Delivery::Result::kTryAgain, "given up: the program ends"};
  const bool hopeless = code == CURLE_URL_MALFORMAT || code == CURLE_UNSUPPORTED_PROTOCOL;
  return {hopeless ? Delivery::Result::kRefused : Delivery::Result::kTryAgain,
          curl_easy_strerror(code)};
}

std::string hostOf(const std::string& url) {
  const std::size_t scheme = url.find("://");
  const std::string rest = scheme == std::string::npos ? url : url.substr(scheme + 3);
  const std::string authority = rest.substr(0, rest.find_first_of("/?#"));
  const std::size_t at = authority.rfind('@');
  return at == std::string::npos ? authority : authority.substr(at + 1);
}

}  // namespace patina::capture::notify
