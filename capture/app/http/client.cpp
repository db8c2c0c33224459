// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/client.h"

#include <curl/curl.h>

#include <cerrno>
#include <exception>
#include <memory>

namespace patina::http {
namespace {

constexpr std::size_t kReplyBytesMax = 64 << 20;
constexpr long kAnswerS = 60, kConnectS = 5;
constexpr long kSilenceS = 60;  // of a stream that should beat every 15 s

struct Transfer {
  std::function<bool(std::string_view)> take;  // false: enough
  std::stop_token stop;
  std::exception_ptr error;  // must not pass through C
};

std::size_t onData(char* bytes, std::size_t one, std::size_t count, void* transfer) {
  auto& to = *static_cast<Transfer*>(transfer);
  try {
    if (to.take({bytes, one * count})) return one * count;
  } catch (...) {
    to.error = std::current_exception();
  }
  return CURL_WRITEFUNC_ERROR;
}

int onProgress(void* transfer, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return static_cast<Transfer*>(transfer)->stop.stop_requested() ? 1 : 0;
}

class Call {
 public:
  Call(const std::filesystem::path& socket, const std::string& method, const std::string& path)
      : socket_(socket), curl_(make()) {
    set(CURLOPT_UNIX_SOCKET_PATH, socket_.c_str());
    set(CURLOPT_URL, ("http://localhost" + path).c_str());
    set(CURLOPT_PATH_AS_IS, 1L);
    set(CURLOPT_CUSTOMREQUEST, method.c_str());
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_PROXY, "");  // whatever the environment says
    set(CURLOPT_CONNECTTIMEOUT, kConnectS);
    set(CURLOPT_WRITEFUNCTION, &onData);
    set(CURLOPT_WRITEDATA, &transfer_);
    set(CURLOPT_NOPROGRESS, 0L);
    set(CURLOPT_XFERINFOFUNCTION, &onProgress);
    set(CURLOPT_XFERINFODATA, &transfer_);
  }
  ~Call() {
    curl_slist_free_all(fields_);
    curl_easy_cleanup(curl_);
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  template <class Value>
  void set(CURLoption option, Value value) {
    curl_easy_setopt(curl_, option, value);
  }
  void field(const std::string& line) { fields_ = curl_slist_append(fields_, line.c_str()); }

  CURLcode run(Transfer transfer) {
    transfer_ = std::move(transfer);
    set(CURLOPT_HTTPHEADER, fields_);
    const CURLcode code = curl_easy_perform(curl_);
    if (transfer_.error) std::rethrow_exception(transfer_.error);
    return code;
  }

  int status() const {
    long status = 0;
    curl_easy_getinfo(curl_, CURLINFO_RESPONSE_CODE, &status);
    return static_cast<int>(status);
  }
  std::string contentType() const {
    const char* type = nullptr;
    curl_easy_getinfo(curl_, CURLINFO_CONTENT_TYPE, &type);
    return type == nullptr ? "" : type;
  }

  [[noreturn]] void fail(CURLcode code) const {
    const std::string where = socket_.string() + ": ";
    long error = 0;
    curl_easy_getinfo(curl_, CURLINFO_OS_ERRNO, &error);
    if (code == CURLE_COULDNT_CONNECT && error == EACCES)
      throw HttpError(Exit::kPermission, where + "may not be used: join the socket's group");
    if (code == CURLE_COULDNT_CONNECT)
      throw HttpError(Exit::kUnavailable,
                      where + "no daemon listens here: start `patina daemon --archive DIR`");
    throw HttpError(Exit::kTemporary, where + "the daemon hung up: " + curl_easy_strerror(code));
  }

 private:
  static CURL* make() {
    static const CURLcode ready = curl_global_init(CURL_GLOBAL_DEFAULT);
    CURL* const made = ready == CURLE_OK ? curl_easy_init() : nullptr;
    if (made == nullptr) throw HttpError(Exit::kTemporary, "libcurl does not start");
    return made;
  }

  std::filesystem::path socket_;
  Transfer transfer_;
  CURL* curl_;
  curl_slist* fields_ = nullptr;
};

}  // namespace

Reply Client::call(const std::string& method, const std::string& path, const std::string& body) {
  Call request(socket_, method, path);
  request.set(CURLOPT_TIMEOUT, kAnswerS);
  if (method != "GET") {
    request.field("Content-Type: application/json");
    request.field("Expect:");
    request.set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(body.size()));
    request.set(CURLOPT_POSTFIELDS, body.c_str());
  }
  Reply reply;
  const CURLcode code = request.run({.take =
                                         [&reply](std::string_view bytes) {
                                           reply.body += bytes;
                                           return reply.body.size() <= kReplyBytesMax;
                                         },
                                     .stop = {},
                                     .error = {}});
  if (reply.body.size() > kReplyBytesMax)
    throw HttpError(Exit::kBadData, path + ": the answer is over 64 MiB: ask for less");
  if (code != CURLE_OK) request.fail(code);
  reply.status = request.status();
  reply.content_type = request.contentType();
  return reply;
}

void Client::events(const std::function<void(const Event&)>& call, const std::stop_token& stop,
                    const std::string& last_event_id) {
  Call request(socket_, "GET", "/events");
  request.set(CURLOPT_LOW_SPEED_LIMIT, 1L);
  request.set(CURLOPT_LOW_SPEED_TIME, kSilenceS);
  if (!last_event_id.empty()) request.field("Last-Event-ID: " + last_event_id);
  EventParser parser(call);
  std::string refusal;
  const CURLcode code = request.run({.take =
                                         [&](std::string_view bytes) {
                                           if (request.status() == 200) return parser.feed(bytes);
                                           refusal += bytes.substr(0, 4096);
                                           return refusal.size() < 4096;
                                         },
                                     .stop = stop,
                                     .error = {}});
  if (stop.stop_requested()) return;
  if (code == CURLE_OK && request.status() != 200)
    throw HttpError(Exit::kTemporary, "the daemon refuses its events: " + refusal);
  if (code != CURLE_OK) request.fail(code);
}

}  // namespace patina::http
