// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/fault/fault_script.h"

#include <algorithm>

#include "processing/image/random.h"

namespace patina::devices {

FaultReport::FaultReport(const FaultPlan& plan)
    : faults_(plan.faults), counts_(plan.faults.size(), 0) {}

void FaultReport::countFired(std::size_t index) {
  const std::lock_guard lock(mutex_);
  ++counts_.at(index);
}

std::int64_t FaultReport::fired(std::size_t index) const {
  const std::lock_guard lock(mutex_);
  return counts_.at(index);
}

std::vector<Fault> FaultReport::neverFired() const {
  const std::lock_guard lock(mutex_);
  std::vector<Fault> idle;
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const FaultKind kind = faults_[i].kind;
    const bool elsewhere = happensInWorld(kind) || kind == FaultKind::kPowerCut;
    if (counts_[i] == 0 && !elsewhere) idle.push_back(faults_[i]);
  }
  return idle;
}

FaultScript::FaultScript(const FaultPlan& plan, const std::string& device, MonoTime start,
                         Clock& clock, FaultReport* report)
    : seed_(plan.seed), start_(start), clock_(&clock), report_(report) {
  const Nanoseconds now = clock.mono() - start;
  for (std::size_t i = 0; i < plan.faults.size(); ++i) {
    const Fault& fault = plan.faults[i];
    if (fault.device != device) continue;
    entries_.push_back({fault, i, fault.duration == Nanoseconds{0} && fault.at < now});
  }
}

bool FaultScript::due(const Entry& entry, Nanoseconds since_start) const {
  if (entry.spent || since_start < entry.fault.at) return false;
  return entry.fault.duration == Nanoseconds{0} ||
         since_start - entry.fault.at < entry.fault.duration;
}

std::optional<DueFault> FaultScript::take(FaultKind kind) {
  const MonoTime now = clock_->mono();
  for (Entry& entry : entries_) {
    if (entry.fault.kind != kind || !due(entry, now - start_)) continue;
    const bool one_call = entry.fault.duration == Nanoseconds{0};
    entry.spent = one_call;
    if (report_) report_->countFired(entry.index);
    const auto since = static_cast<std::uint64_t>((now - start_).count());
    return DueFault{one_call ? now : start_ + entry.fault.at + entry.fault.duration,
                    hashSeed(seed_, entry.index, since)};
  }
  return std::nullopt;
}

bool FaultScript::isDue(FaultKind kind) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.fault.kind == kind && due(entry, clock_->mono() - start_);
  });
}

bool FaultScript::plans(FaultKind kind) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Entry& entry) { return entry.fault.kind == kind; });
}

}  // namespace patina::devices
