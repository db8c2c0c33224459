// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/dslr.h"

#include <algorithm>
#include <utility>

#include "devices/twin/dslr/operations.h"

namespace patina::devices::twin::dslr {
namespace {

constexpr Nanoseconds kOffByDefault = std::chrono::seconds(3);
constexpr Nanoseconds kLateByDefault = std::chrono::seconds(2);

Nanoseconds orElse(Nanoseconds duration, Nanoseconds fallback) {
  return duration.count() > 0 ? duration : fallback;
}

PtpReply refusal(Answer code) { return {code, {}, nullptr, 0, 0, std::nullopt}; }

PtpReply silence() {
  PtpReply reply = refusal(Answer::kGeneralError);
  reply.trouble = WireTrouble{WireTrouble::kReset, 0, {}};
  return reply;
}

WireTrouble wireTrouble(const DslrFault& fault) {
  const auto kind = fault.kind == DslrFaultKind::kStall   ? WireTrouble::kStall
                    : fault.kind == DslrFaultKind::kReset ? WireTrouble::kReset
                                                          : WireTrouble::kClose;
  return {kind, std::clamp(fault.amount, 0.0, 1.0), orElse(fault.duration, kForEver)};
}

}  // namespace

Dslr::Dslr(std::shared_ptr<World> world, DslrOptions options)
    : body_(std::move(world), std::move(options)) {}

PtpReply Dslr::perform(const PtpCommand& command) {
  const std::lock_guard lock(mutex_);
  catchUp();
  if (off_until_) return silence();
  const auto fault = misbehaviour_.strike(command.operation, clock().mono());
  if (!fault) return execute(body_, command, {});
  body_.truth.faults.push_back({clock().utc(), *fault, command.operation});
  return performUnder(*fault, command);
}

PtpReply Dslr::performUnder(const DslrFault& fault, const PtpCommand& command) {
  CaptureTrouble trouble;
  switch (fault.kind) {
    case DslrFaultKind::kRefuse:
      return refusal(Answer::kGeneralError);
    case DslrFaultKind::kBusy:
      return refusal(Answer::kDeviceBusy);
    case DslrFaultKind::kPowerLoss:
      losePower(fault.duration);
      return silence();
    case DslrFaultKind::kSettingChanges: {
      const PtpReply reply = execute(body_, command, trouble);
      body_.settings.turnTheDial();
      return reply;
    }
    case DslrFaultKind::kStall:
    case DslrFaultKind::kReset:
    case DslrFaultKind::kClose: {
      PtpReply reply = execute(body_, command, trouble);
      reply.trouble = wireTrouble(fault);
      return reply;
    }
    case DslrFaultKind::kEventsTwice:
      trouble.times = 2;
      break;
    case DslrFaultKind::kEventsLate:
      trouble.late = orElse(fault.duration, kLateByDefault);
      break;
    case DslrFaultKind::kEventsNever:
      trouble.times = 0;
      break;
    case DslrFaultKind::kStalePicture:
      trouble.stale = true;
      break;
    case DslrFaultKind::kCardFull:
      trouble.full = true;
      break;
  }
  return execute(body_, command, trouble);
}

std::vector<PtpEvent> Dslr::takeEvents() {
  const std::lock_guard lock(mutex_);
  catchUp();
  return body_.takeEvents();
}

std::optional<MonoTime> Dslr::nextDue() const {
  const std::lock_guard lock(mutex_);
  std::optional<MonoTime> next = off_until_;
  for (const auto& due : {body_.nextDue(), misbehaviour_.nextPowerLoss()})
    if (due && (!next || *due < *next)) next = due;
  return next;
}

bool Dslr::isOn() const {
  const std::lock_guard lock(mutex_);
  return !off_until_;
}

void Dslr::hangUp() {
  const std::lock_guard lock(mutex_);
  body_.session_open = false;
}

void Dslr::onChange(std::function<void()> call) {
  const std::lock_guard lock(listener_mutex_);
  on_change_ = std::move(call);
}

bool Dslr::pressShutter() {
  {
    const std::lock_guard lock(mutex_);
    catchUp();
    if (off_until_ || body_.capture(0, {}) != Answer::kOk) return false;
  }
  changed();
  return true;
}

void Dslr::order(const DslrFault& fault) {
  {
    const std::lock_guard lock(mutex_);
    misbehaviour_.order(fault, clock().mono() + fault.at);
  }
  changed();
}

void Dslr::misbehave(std::uint64_t seed, double rate, Nanoseconds duration) {
  const std::lock_guard lock(mutex_);
  misbehaviour_.randomly(seed, rate, duration);
}

void Dslr::behave() {
  const std::lock_guard lock(mutex_);
  misbehaviour_.clear();
}

void Dslr::turnOff(Nanoseconds duration) {
  {
    const std::lock_guard lock(mutex_);
    losePower(duration);
  }
  changed();
}

void Dslr::setBattery(int percent) { set(Property::kBatteryLevel, percent); }

void Dslr::set(Property property, std::int64_t value) {
  {
    const std::lock_guard lock(mutex_);
    body_.settings.set(property, value);
    body_.say({EventCode::kDevicePropChanged, 0, {static_cast<std::uint32_t>(property)}});
  }
  changed();
}

Truth Dslr::truth() const {
  const std::lock_guard lock(mutex_);
  return body_.truth;
}

std::vector<TruePicture> Dslr::picturesSince(std::size_t first) const {
  const std::lock_guard lock(mutex_);
  const auto& all = body_.truth.pictures;
  return {all.begin() + static_cast<std::ptrdiff_t>(std::min(first, all.size())), all.end()};
}

void Dslr::catchUp() {
  if (const auto fault = misbehaviour_.powerLoss(clock().mono())) {
    body_.truth.faults.push_back({clock().utc(), *fault, {}});
    losePower(fault->duration);
  }
  if (off_until_ && *off_until_ <= clock().mono()) off_until_.reset();
  if (!off_until_) body_.finishDue();
}

void Dslr::losePower(Nanoseconds duration) {
  body_.losePower();
  off_until_ = clock().mono() + orElse(duration, kOffByDefault);
}

void Dslr::changed() {
  const std::lock_guard lock(listener_mutex_);
  if (on_change_) on_change_();
}

}  // namespace patina::devices::twin::dslr
