// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/network/freshness.h"
#include "devices/network/http_get.h"
#include "devices/network/picture_source.h"

namespace patina::devices::network {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kBeforeAnother = 100ms;  // request, when a picture was stale

class SnapshotSource final : public PictureSource {
 public:
  SnapshotSource(const CameraSettings& settings, Clock& clock)
      : settings_(settings), clock_(clock) {
    get_.who = settings.who;
    get_.url = settings.url;
    get_.credentials = settings.credentials;
    get_.ca_file = settings.ca_file;
    get_.bytes_max = settings.bytes_max;
    get_.connect_limit = settings.connect_timeout;
  }

  Result<void> open(MonoTime deadline) override {
    auto reply = picture(deadline);
    if (!reply) return tl::make_unexpected(reply.error());
    freshness_ = {};
    freshness_.learn(*reply, clock_.utc(), clock_.mono());
    freshness_.remember(*reply);
    return {};
  }

  // Asked again until one is new: many cameras make a picture a second, whoever asks.
  Result<Fetched> fetch(MonoTime trigger, MonoTime deadline) override {
    if (trigger + settings_.latency >= deadline) {
      clock_.sleepUntil(deadline, {});
      return fail(Errc::kTimeout, settings_.who + ": the deadline leaves no time for the latency");
    }
    clock_.sleepUntil(trigger + settings_.latency, {});
    for (std::string stale;;) {
      auto reply = picture(deadline);
      if (!reply && reply.error().code == Errc::kTimeout && !stale.empty())
        return fail(Errc::kCorrupt, settings_.who + ": no new picture: " + stale);
      if (!reply) return tl::make_unexpected(reply.error());
      stale = freshness_.whyStale(*reply, trigger);
      freshness_.remember(*reply);
      if (stale.empty()) {
        const MonoTime taken = reply->sent + (reply->first_byte - reply->sent) / 2;
        return Fetched{std::move(reply->body), taken};
      }
      if (clock_.mono() + kBeforeAnother >= deadline)
        return fail(Errc::kCorrupt, settings_.who + ": no new picture: " + stale);
      clock_.sleepUntil(clock_.mono() + kBeforeAnother, {});
    }
  }

 private:
  // A good answer that holds what the rig file says.
  Result<HttpReply> picture(MonoTime deadline) {
    auto reply = httpGet(get_, clock_, deadline);
    if (!reply) return reply;
    const std::string what = settings_.who + ": " + settings_.url + ": ";
    const std::string& type = reply->content_type;
    if (!type.empty() && type.rfind("image/", 0) != 0 &&
        type.rfind("application/octet-stream", 0) != 0)
      return fail(Errc::kCorrupt, what + "the answer is '" + type.substr(0, 80) +
                                      "', no picture: is this the address of the snapshot?");
    const std::string got = extensionOf(sniffFormat(reply->body));
    if (got != settings_.ext)
      return fail(Errc::kCorrupt, what + "the answer is " + (got == "bin" ? "no picture" : got) +
                                      ", settings.format says " + settings_.ext);
    try {
      readPictureHeader(reply->body);
    } catch (const ProcessingError& problem) {
      return fail(Errc::kCorrupt, what + problem.what());
    }
    return reply;
  }

  const CameraSettings& settings_;
  Clock& clock_;
  HttpGet get_;
  Freshness freshness_;
};

}  // namespace

std::unique_ptr<PictureSource> makeSnapshotSource(const CameraSettings& settings, Clock& clock) {
  return std::make_unique<SnapshotSource>(settings, clock);
}

}  // namespace patina::devices::network
