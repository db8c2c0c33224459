// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "devices/host/answers.h"
#include "devices/host/hosted_devices.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;

// What is left of a deadline for the driver itself: it should answer before it is killed.
Nanoseconds driversShare(Nanoseconds left) {
  return left - std::min<Nanoseconds>(left / 10, 200ms);
}

bool close(double a, double b) { return std::abs(a - b) <= 0.01 * std::abs(b); }

class HostedCamera final : public Camera {
 public:
  HostedCamera(CameraCaps caps, std::shared_ptr<DriverLink> link, std::uint16_t place,
               CameraLimits limits, Clock& clock)
      : caps_(std::move(caps)),
        link_(std::move(link)),
        place_(place),
        limits_(limits),
        clock_(clock) {}

  const CameraCaps& caps() const override { return caps_; }
  Result<Applied> configure(const Exposure& exposure) override;
  Result<Ticket> trigger(const ShotRequest& request) override;
  Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) override;
  Result<void> release(const RawFrame& frame) override;
  Result<std::vector<CameraEvent>> poll() override;
  Result<void> recover(Rung rung) override;

 private:
  template <class T>
  Result<T> ask(Op op, const Bytes& body) {
    if (!opened_) return closed(op);
    return answered<T>(*link_, place_, op, body, limits_.call);
  }
  // Of `opening`.
  Nanoseconds leftSince(MonoTime begun) const { return begun + limits_.opening - real_.mono(); }
  tl::unexpected<Error> closed(Op op) const {
    return fail(Errc::kRefused,
                "camera '" + caps_.id + "': " + name(op) + ": recover() comes first");
  }
  Result<void> climb(Rung rung, MonoTime begun);
  Result<void> recycle();
  RawFrame toOurs(RawFrame frame) const;

  CameraCaps caps_;
  std::shared_ptr<DriverLink> link_;
  std::uint16_t place_;
  CameraLimits limits_;
  Clock& clock_;
  RealClock real_;
  std::optional<Exposure> asked_, applied_;  // by the last configure that worked
  int shots_ = 0;                            // since the process was started
  bool opened_ = false;                      // a rung was tried: it is lost rather than closed
};

Result<Applied> HostedCamera::configure(const Exposure& exposure) {
  asked_.reset();
  const auto applied = ask<Exposure>(Op::kConfigure, bodyOf(exposure));
  if (!applied) return tl::make_unexpected(applied.error());
  asked_ = exposure;
  applied_ = *applied;
  return Applied{*applied};
}

Result<Ticket> HostedCamera::trigger(const ShotRequest& request) {
  auto ticket = ask<Ticket>(Op::kTrigger, bodyOf(request));
  if (!ticket) return ticket;
  ticket->began_utc = link_->ours(ticket->began_utc);
  ticket->began_mono = link_->ours(ticket->began_mono);
  return ticket;
}

RawFrame HostedCamera::toOurs(RawFrame frame) const {
  frame.utc = link_->ours(frame.utc);
  frame.mono = link_->ours(frame.mono);
  return frame;
}

Result<std::vector<RawFrame>> HostedCamera::collect(const Ticket& ticket, MonoTime deadline) {
  if (!opened_) return closed(Op::kCollect);
  const Nanoseconds left = std::max<Nanoseconds>(deadline - clock_.mono(), 0ns);
  Writer body;
  put(body, ticket);
  body.i64((clock_.threadSafe() ? driversShare(left) : left).count());
  // Told time costs what the work costs, not what the deadline says.
  const Nanoseconds limit = clock_.threadSafe() ? left : limits_.call;
  auto reply = link_->call(place_, Op::kCollect, body.take(), limit);
  if (!reply) return tl::make_unexpected(reply.error());
  std::vector<RawFrame> frames;
  std::vector<Seen> seen;
  Reader from(reply->part ? std::span<const std::byte>(*reply->part)
                          : std::span<const std::byte>());
  get(from, frames);
  bool whole = from.whole();
  if (!reply->cut) {
    Reader verdicts(reply->body);
    get(verdicts, seen);
    whole = whole && verdicts.whole() && seen.size() == frames.size();
  }
  if (!whole) return damagedAnswer(Op::kCollect);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    frames[i] = toOurs(std::move(frames[i]));
    frames[i].seen = reply->cut ? Seen{"its decoder did not end: " + reply->cut->what, {}, 0, {}}
                                : std::move(seen[i]);
  }
  ++shots_;
  return frames;
}

Result<void> HostedCamera::release(const RawFrame& frame) {
  RawFrame card = frame;
  card.bytes.clear();
  card.seen.reset();
  return ask<void>(Op::kRelease, bodyOf(card));
}

Result<std::vector<CameraEvent>> HostedCamera::poll() {
  auto events = ask<std::vector<CameraEvent>>(Op::kPoll, {});
  if (!events) return events;
  const bool grown = link_->memoryBytes() > limits_.recycle_bytes;
  if (shots_ < limits_.recycle_shots && !grown) return events;
  if (auto done = recycle(); !done) return tl::make_unexpected(done.error());
  events->push_back({grown ? "its driver's process had grown too large and was started anew"
                           : "its driver's process was started anew, as after every " +
                                 std::to_string(limits_.recycle_shots) + " shots"});
  return events;
}

Result<void> HostedCamera::recycle() {
  const MonoTime begun = real_.mono();
  link_->stop();
  if (auto up = climb(Rung::kReopen, begun); !up) return up;
  if (!asked_) return {};
  const Exposure before = *applied_;
  const auto again = configure(*asked_);
  if (!again) return tl::make_unexpected(again.error());
  const Exposure& now = again->exposure;
  if (close(toSeconds(now.time), toSeconds(before.time)) &&
      close(now.iso.value, before.iso.value) && close(now.f_number.value, before.f_number.value))
    return {};
  return fail(Errc::kRefused, "camera '" + caps_.id +
                                  "': its settings are others since its driver was started anew");
}

Result<void> HostedCamera::climb(Rung rung, MonoTime begun) {
  if (!link_->running()) {
    if (auto up = link_->start(); !up) return up;
    shots_ = 0;
    rung = std::max(rung, Rung::kReopen);  // a new process has nothing open
  }
  Writer body;
  body.u8(static_cast<std::uint8_t>(rung));
  const Nanoseconds limit = rung >= Rung::kReopen ? leftSince(begun) : limits_.call;
  auto up = answered<void>(*link_, place_, Op::kRecover, body.take(), limit);
  if (up) link_->rested();
  return up;
}

Result<void> HostedCamera::recover(Rung rung) {
  opened_ = true;
  const MonoTime begun = real_.mono();
  if (rung >= Rung::kReset) link_->stop();
  auto up = climb(rung, begun);
  // A driver that cannot open its camera again in the old process can in a new one.
  if (up || rung != Rung::kReopen || !link_->running()) return up;
  if (leftSince(begun) < limits_.opening / 2) return up;
  link_->stop();
  return climb(rung, begun);
}

}  // namespace

std::unique_ptr<Camera> makeHostedCamera(CameraCaps caps, std::shared_ptr<DriverLink> link,
                                         std::uint16_t place, CameraLimits limits, Clock& clock) {
  return std::make_unique<HostedCamera>(std::move(caps), std::move(link), place, limits, clock);
}

}  // namespace patina::devices::host
