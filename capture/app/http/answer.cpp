// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/answer.h"

#include <fcntl.h>
#include <linux/openat2.h>
#include <microhttpd.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <memory>

#include "capture/app/http/byte_range.h"

namespace patina::http {
namespace {

struct Held {
  std::string body;
  ByteBudget::Share share;
};

void release(void* held) { delete static_cast<Held*>(held); }

bool isFresh(const std::string& if_none_match, const Response& response) {
  const auto tag = response.headers.find("ETag");
  return tag != response.headers.end() && !tag->second.empty() && if_none_match == tag->second;
}

Response storeError() {
  return errorResponse(500, Exit::kIo, "the file cannot be read: run `patina archive verify`");
}

}  // namespace

const std::map<std::string, std::string>& protectiveHeaders() {
  static const std::map<std::string, std::string> headers = {
      {"Content-Security-Policy",
       "default-src 'self'; img-src 'self' blob:; object-src 'none'; form-action 'none'; "
       "frame-ancestors 'none'; base-uri 'none'"},
      {"X-Content-Type-Options", "nosniff"},
      {"X-Frame-Options", "DENY"},
      {"Referrer-Policy", "no-referrer"},
      {"Cross-Origin-Opener-Policy", "same-origin"},
      {"Cross-Origin-Resource-Policy", "same-origin"},
      {"Permissions-Policy", "camera=(), microphone=(), geolocation=()"},
      {"Cache-Control", "no-store"}};
  return headers;
}

void addHeaders(MHD_Response* to, const Response& response) {
  for (const auto& [name, value] : protectiveHeaders())
    if (!response.headers.contains(name)) MHD_add_response_header(to, name.c_str(), value.c_str());
  for (const auto& [name, value] : response.headers)
    MHD_add_response_header(to, name.c_str(), value.c_str());
  if (!response.content_type.empty())
    MHD_add_response_header(to, "Content-Type", response.content_type.c_str());
}

AnswerMaker::AnswerMaker(const std::filesystem::path& archive, ByteBudget& budget)
    : archive_(archive),
      root_(archive.empty() ? -1 : open(archive.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)),
      budget_(budget) {
  if (!archive.empty() && root_.fd() < 0)
    throw HttpError(Exit::kIo, archive.string() + ": the archive's folder cannot be opened");
}

Answer AnswerMaker::make(const Admission& admission, Response response) const {
  if (isFresh(admission.if_none_match, response)) {
    response.status = 304;
    response.body.clear();
    response.file.clear();
    response.content_type.clear();
  }
  return response.file.empty() ? fromBody(std::move(response))
                               : fromFile(admission, std::move(response));
}

Answer AnswerMaker::fromBody(Response response) const {
  auto held = std::make_unique<Held>();
  held->share = budget_.take(response.body.size());
  if (!held->share) {
    response = errorResponse(503, Exit::kTemporary, "too much is asked at once: try again");
    response.headers["Retry-After"] = "5";
  }
  held->body = std::move(response.body);
  const std::uint64_t bytes = held->body.size();
  MHD_Response* const to = MHD_create_response_from_buffer_with_free_callback_cls(
      held->body.size(), held->body.data(), &release, held.get());
  if (to == nullptr) return {};
  static_cast<void>(held.release());  // release() deletes it
  addHeaders(to, response);
  return {to, response.status, bytes};
}

// The kernel itself refuses "..", links and mounts' tricks on the way: whatever a handler has made
// of a request, nothing outside the archive is opened.
devices::Descriptor AnswerMaker::openBeneath(const std::filesystem::path& file) const {
  const std::filesystem::path beneath = file.lexically_relative(archive_);
  const bool is_named_whole = !beneath.empty() && *beneath.begin() != "..";
  const std::filesystem::path& inside = is_named_whole ? beneath : file;
  open_how how{};
  how.flags = O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;
  how.resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS | RESOLVE_NO_MAGICLINKS;
  return devices::Descriptor(
      static_cast<int>(syscall(SYS_openat2, root_.fd(), inside.c_str(), &how, sizeof how)));
}

Answer AnswerMaker::fromFile(const Admission& admission, Response response) const {
  if (root_.fd() < 0) return fromBody(storeError());
  devices::Descriptor file = openBeneath(response.file);
  struct stat facts {};
  if (file.fd() < 0 && errno == ENOENT)
    return fromBody(errorResponse(404, Exit::kUnavailable, "the file is not in the archive"));
  if (file.fd() < 0 || fstat(file.fd(), &facts) != 0 || !S_ISREG(facts.st_mode))
    return fromBody(storeError());
  const auto size = static_cast<std::uint64_t>(facts.st_size);
  const ByteRange range = chooseRange(admission.range, size);
  if (range.kind == ByteRange::kRefused) {
    Response refusal = errorResponse(416, Exit::kUsage, "ask for one range inside the file");
    refusal.headers["Content-Range"] = "bytes */" + std::to_string(size);
    return fromBody(std::move(refusal));
  }
  response.headers["Accept-Ranges"] = "bytes";
  // A camera's bytes are never shown in place: a browser could be made to run them.
  response.headers.emplace("Content-Disposition", "attachment");
  if (range.kind == ByteRange::kPart) {
    response.status = 206;
    response.headers["Content-Range"] = "bytes " + std::to_string(range.first) + "-" +
                                        std::to_string(range.first + range.bytes - 1) + "/" +
                                        std::to_string(size);
  }
  MHD_Response* const to =
      MHD_create_response_from_fd_at_offset64(range.bytes, file.fd(), range.first);
  if (to == nullptr) return {};
  file.release();
  addHeaders(to, response);
  return {to, response.status, range.bytes};
}

}  // namespace patina::http
