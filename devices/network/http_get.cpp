// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/network/http_get.h"

#include <curl/curl.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <string_view>

#include "devices/network/camera_settings.h"

namespace patina::devices::network {
namespace {

using namespace std::chrono_literals;

constexpr int kRedirectsMost = 3;
constexpr std::size_t kHeadersMost = 64 * 1024;  // bytes

struct FreeEasy {
  void operator()(CURL* easy) const { curl_easy_cleanup(easy); }
};
using Easy = std::unique_ptr<CURL, FreeEasy>;

struct Transfer {
  Clock* clock = nullptr;
  std::uint64_t bytes_max = 0;
  bool too_long = false;
  std::size_t header_bytes = 0;
  HttpReply reply;
};

std::optional<UtcTime> timeOf(const std::string& text) {
  const time_t seconds = curl_getdate(text.c_str(), nullptr);
  if (seconds < 0) return std::nullopt;
  return UtcTime{std::chrono::seconds(seconds)};
}

std::string trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\r' || c == '\n' || c == '\t'; };
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  return std::string(text);
}

std::size_t takeHeader(char* data, std::size_t size, std::size_t count, void* user) {
  auto& transfer = *static_cast<Transfer*>(user);
  const std::string_view line(data, size * count);
  transfer.header_bytes += line.size();
  if (transfer.header_bytes > kHeadersMost) return 0;
  if (line.rfind("HTTP/", 0) == 0) {  // of a new answer: what came before was another's
    const MonoTime sent = transfer.reply.sent;
    transfer.reply = {};
    transfer.reply.sent = sent;
    transfer.reply.first_byte = transfer.clock->mono();
    return line.size();
  }
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos) return line.size();
  std::string key(line.substr(0, colon));
  std::transform(key.begin(), key.end(), key.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::string value = trimmed(line.substr(colon + 1));
  if (key == "date") transfer.reply.date = timeOf(value);
  if (key == "last-modified") transfer.reply.last_modified = timeOf(value);
  if (key == "content-type") transfer.reply.content_type = value;
  std::int64_t seconds = 0;
  if (key == "age" &&
      std::from_chars(value.data(), value.data() + value.size(), seconds).ec == std::errc{})
    transfer.reply.age = std::chrono::seconds(std::clamp<std::int64_t>(seconds, 0, 1'000'000'000));
  return line.size();
}

std::size_t takeBody(char* data, std::size_t size, std::size_t count, void* user) {
  auto& transfer = *static_cast<Transfer*>(user);
  Bytes& body = transfer.reply.body;
  if (body.size() + size * count > transfer.bytes_max) {
    transfer.too_long = true;
    return 0;
  }
  const auto* begin = reinterpret_cast<const std::byte*>(data);
  body.insert(body.end(), begin, begin + size * count);
  return size * count;
}

void prepare(CURL* easy, const HttpGet& get, const std::string& url, Nanoseconds limit,
             Transfer& transfer) {
  const auto ms = [](Nanoseconds d) {
    return static_cast<long>(std::max<std::int64_t>(1, d.count() / 1'000'000));
  };
  curl_easy_setopt(easy, CURLOPT_URL, url.c_str());
  curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 0L);
  curl_easy_setopt(easy, CURLOPT_PROXY, "");
  curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(easy, CURLOPT_TIMEOUT_MS, ms(limit));
  curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT_MS, ms(std::min(limit, get.connect_limit)));
  curl_easy_setopt(easy, CURLOPT_USERAGENT, "patina");
  curl_easy_setopt(easy, CURLOPT_HEADERFUNCTION, takeHeader);
  curl_easy_setopt(easy, CURLOPT_HEADERDATA, &transfer);
  curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, takeBody);
  curl_easy_setopt(easy, CURLOPT_WRITEDATA, &transfer);
  if (!get.ca_file.empty()) curl_easy_setopt(easy, CURLOPT_CAINFO, get.ca_file.c_str());
  if (!get.credentials.empty()) {
    curl_easy_setopt(easy, CURLOPT_HTTPAUTH, CURLAUTH_BASIC | CURLAUTH_DIGEST);
    curl_easy_setopt(easy, CURLOPT_USERPWD, get.credentials.c_str());
  }
}

tl::unexpected<Error> failed(const HttpGet& get, CURLcode code, const Transfer& transfer) {
  const std::string what = get.who + ": " + get.url + ": ";
  if (transfer.too_long)
    return fail(Errc::kCorrupt, what + "the answer is longer than settings.bytes_max, " +
                                    formatBytes(get.bytes_max));
  const std::string why = curl_easy_strerror(code);
  switch (code) {
    case CURLE_OPERATION_TIMEDOUT:
      return fail(Errc::kTimeout, what + "no picture by the deadline");
    case CURLE_PARTIAL_FILE:
    case CURLE_GOT_NOTHING:
    case CURLE_WEIRD_SERVER_REPLY:
    case CURLE_WRITE_ERROR:
      return fail(Errc::kCorrupt, what + "the answer broke off (" + why + ")");
    case CURLE_PEER_FAILED_VERIFICATION:
    case CURLE_SSL_CACERT_BADFILE:
    case CURLE_SSL_CONNECT_ERROR:
      return fail(Errc::kRefused, what + "no secure connection (" + why +
                                      "); of a certificate of your own name the authority: "
                                      "settings.ca_file");
    default:
      return fail(Errc::kLost, what + why + "; is the camera on, and is the address right?");
  }
}

tl::unexpected<Error> refusedBy(const HttpGet& get, long status) {
  const std::string what = get.who + ": " + get.url + ": HTTP " + std::to_string(status);
  if (status == 401 || status == 403)
    return fail(Errc::kRefused,
                what + ": the camera wants other credentials: settings.credentials");
  if (status == 429 || status >= 500) return fail(Errc::kBusy, what);
  return fail(Errc::kRefused, what + ": is the address right?");
}

// Where an answer sends us on; empty: nowhere.
Result<std::string> redirectOf(CURL* easy, const HttpGet& get, const std::string& from) {
  const char* to = nullptr;
  curl_easy_getinfo(easy, CURLINFO_REDIRECT_URL, &to);
  if (!to) return std::string{};
  const bool downgrade =
      from.rfind("https://", 0) == 0 && std::string(to).rfind("https://", 0) != 0;
  if (hostOf(to) != hostOf(get.url) || downgrade)
    return fail(Errc::kRefused, get.who + ": " + get.url + " sends on to " + hostOf(to) +
                                    ", which is not followed: name the final address");
  return std::string(to);
}

}  // namespace

Result<HttpReply> httpGet(const HttpGet& get, Clock& clock, MonoTime deadline) {
  static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
  std::string url = get.url;
  for (int redirects = 0; redirects <= kRedirectsMost; ++redirects) {
    const Nanoseconds left = deadline - clock.mono();
    if (left <= 0ns) return fail(Errc::kTimeout, get.who + ": no picture by the deadline");
    const Easy easy(ready == CURLE_OK ? curl_easy_init() : nullptr);
    if (!easy) return fail(Errc::kBusy, get.who + ": out of memory");
    Transfer transfer;
    transfer.clock = &clock;
    transfer.bytes_max = get.bytes_max;
    transfer.reply.sent = clock.mono();
    prepare(easy.get(), get, url, left, transfer);
    if (const CURLcode code = curl_easy_perform(easy.get()); code != CURLE_OK)
      return failed(get, code, transfer);
    long status = 0;
    curl_easy_getinfo(easy.get(), CURLINFO_RESPONSE_CODE, &status);
    if (status == 200) return std::move(transfer.reply);
    const auto next = redirectOf(easy.get(), get, url);
    if (!next) return tl::make_unexpected(next.error());
    if (next->empty()) return refusedBy(get, status);
    url = *next;
  }
  return fail(Errc::kRefused, get.who + ": " + get.url + " sends on more than three times");
}

}  // namespace patina::devices::network
