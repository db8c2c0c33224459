// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/misbehaviour.h"

#include <algorithm>
#include <array>

#include "processing/image/random.h"

namespace patina::devices::twin::dslr {
namespace {

using enum DslrFaultKind;

struct KindName {
  DslrFaultKind kind;
  const char* name;
};
constexpr std::array kKinds{KindName{kRefuse, "refuse"},
                            KindName{kBusy, "busy"},
                            KindName{kStall, "stall"},
                            KindName{kReset, "reset"},
                            KindName{kClose, "close"},
                            KindName{kEventsTwice, "events_twice"},
                            KindName{kEventsLate, "events_late"},
                            KindName{kEventsNever, "events_never"},
                            KindName{kStalePicture, "stale_picture"},
                            KindName{kCardFull, "card_full"},
                            KindName{kSettingChanges, "setting_changes"},
                            KindName{kPowerLoss, "power_loss"}};

bool isTransfer(Operation operation) {
  return operation == Operation::kGetObject || operation == Operation::kGetPartialObject;
}

// Whether the kind befalls this operation when none was named.
bool befalls(const DslrFault& fault, Operation operation) {
  switch (fault.kind) {
    case kRefuse:
    case kBusy:
    case kEventsTwice:
    case kEventsLate:
    case kEventsNever:
    case kStalePicture:
    case kCardFull:
      return operation == Operation::kInitiateCapture;
    case kSettingChanges:
      return operation == Operation::kSetDevicePropValue;
    case kStall:
    case kReset:
    case kClose:
      return fault.amount == 0 || isTransfer(operation);
    case kPowerLoss:
      return true;
  }
  return false;
}

bool hits(const DslrFault& fault, Operation operation) {
  return fault.operation ? *fault.operation == operation : befalls(fault, operation);
}

bool hasWindow(DslrFaultKind kind) { return kind == kRefuse || kind == kBusy || kind == kCardFull; }

std::vector<DslrFaultKind> chancesOf(Operation operation) {
  switch (operation) {
    case Operation::kInitiateCapture:
      return {kRefuse,      kBusy,         kStall,    kReset,     kEventsTwice,   kEventsLate,
              kEventsNever, kStalePicture, kCardFull, kPowerLoss, kSettingChanges};
    case Operation::kGetObject:
    case Operation::kGetPartialObject:
      return {kRefuse, kBusy, kStall, kReset, kClose, kPowerLoss};
    case Operation::kSetDevicePropValue:
      return {kRefuse, kBusy, kStall, kReset, kSettingChanges};
    default:
      return {kRefuse, kBusy, kStall, kReset, kClose, kPowerLoss};
  }
}

}  // namespace

const char* name(DslrFaultKind kind) {
  return std::ranges::find(kKinds, kind, &KindName::kind)->name;
}

std::vector<DslrFaultKind> allDslrFaults() {
  std::vector<DslrFaultKind> all;
  for (const KindName& known : kKinds) all.push_back(known.kind);
  return all;
}

void Misbehaviour::order(const DslrFault& fault, MonoTime due) {
  orders_.push_back({fault, due, MonoTime::min()});
}

void Misbehaviour::randomly(std::uint64_t seed, double rate, Nanoseconds duration) {
  seed_ = seed;
  rate_ = rate;
  longest_ = duration;
  operations_ = 0;
}

void Misbehaviour::clear() {
  orders_.clear();
  rate_ = 0;
}

std::optional<DslrFault> Misbehaviour::strike(Operation operation, MonoTime now) {
  std::erase_if(orders_, [&](const Order& order) {
    return order.until != MonoTime::min() && order.until <= now;
  });
  for (auto order = orders_.begin(); order != orders_.end(); ++order) {
    if (order->due > now || !hits(order->fault, operation)) continue;
    const DslrFault fault = order->fault;
    if (!hasWindow(fault.kind) || fault.duration.count() <= 0) {
      orders_.erase(order);
    } else if (order->until == MonoTime::min()) {
      order->until = now + fault.duration;
    }
    return fault;
  }
  return byChance(operation);
}

std::optional<DslrFault> Misbehaviour::byChance(Operation operation) {
  const std::uint64_t own = hashSeed(seed_, operations_++);
  if (!(uniform(hashSeed(own, 0)) < rate_)) return std::nullopt;
  const auto kinds = chancesOf(operation);
  DslrFault fault;
  fault.kind = kinds[uniformBelow(hashSeed(own, 1), kinds.size())];
  fault.operation = operation;
  fault.duration =
      Nanoseconds(1 + static_cast<std::int64_t>(uniform(hashSeed(own, 2)) *
                                                static_cast<double>(longest_.count())));
  fault.amount = isTransfer(operation) ? uniform(hashSeed(own, 3)) : 0;
  return fault;
}

std::optional<DslrFault> Misbehaviour::powerLoss(MonoTime now) {
  const auto order = std::ranges::find_if(orders_, [&](const Order& one) {
    return one.fault.kind == kPowerLoss && !one.fault.operation && one.due <= now;
  });
  if (order == orders_.end()) return std::nullopt;
  const DslrFault fault = order->fault;
  orders_.erase(order);
  return fault;
}

std::optional<MonoTime> Misbehaviour::nextPowerLoss() const {
  std::optional<MonoTime> next;
  for (const Order& order : orders_)
    if (order.fault.kind == kPowerLoss && !order.fault.operation && (!next || order.due < *next))
      next = order.due;
  return next;
}

}  // namespace patina::devices::twin::dslr
