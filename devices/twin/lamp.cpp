// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/lamp.h"

#include <algorithm>
#include <cmath>

#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

std::uint64_t hashOf(const std::string& text) {
  std::uint64_t h = 0;
  for (const char c : text) h = hashSeed(h, static_cast<unsigned char>(c));
  return h;
}

Nanoseconds endOf(const Fault& fault) {
  return fault.duration.count() > 0 ? fault.at + fault.duration : Nanoseconds::max();
}

// Share of [begin, end) inside the fault; an empty interval counts as its instant.
double overlap(const Fault& fault, Nanoseconds begin, Nanoseconds end) {
  if (end <= begin) return begin >= fault.at && begin < endOf(fault) ? 1 : 0;
  const auto from = std::max(begin, fault.at), to = std::min(end, endOf(fault));
  return to > from ? toSeconds(to - from) / toSeconds(end - begin) : 0;
}

}  // namespace

Lamp::Lamp(const LightSpec& spec, bool incandescent, const LampProfile& profile,
           const FaultPlan& faults, std::uint64_t seed, Nanoseconds now)
    : profile_(profile),
      incandescent_(incandescent),
      seed_(hashSeed(seed, hashOf(spec.id), 0x1a3bull)) {
  for (const Fault& fault : faults.faults)
    if (fault.device == spec.id && placeOf(fault.kind) == FaultPlace::kLight)
      faults_.push_back(fault);
  if (spec.between == Between::kOn && now.count() > 0) {
    set_ = 1;
    warmth_ = warmthAt(now);
  }
  since_ = now;
}

void Lamp::set(double level, Nanoseconds now) {
  warmth_ = warmthAt(now);
  since_ = std::max(now, since_);
  set_ = level;
}

double Lamp::warmthAt(Nanoseconds now) const {
  if (now <= since_) return warmth_;
  std::vector<Nanoseconds> cuts{since_, now};
  for (const Fault& fault : faults_)
    if (fault.kind == FaultKind::kLampDead)
      for (const Nanoseconds cut : {fault.at, endOf(fault)})
        if (cut > since_ && cut < now) cuts.push_back(cut);
  std::sort(cuts.begin(), cuts.end());
  double warmth = warmth_;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    bool dead = false;
    for (const Fault& fault : faults_)
      dead |= fault.kind == FaultKind::kLampDead && overlap(fault, cuts[i], cuts[i]) > 0;
    const double target = dead ? 0 : set_;
    const double keep =
        std::exp(-toSeconds(cuts[i + 1] - cuts[i]) / toSeconds(profile_.warm_up_tau));
    warmth = target + (warmth - target) * keep;
  }
  return warmth;
}

double Lamp::rippleOver(Nanoseconds begin, Nanoseconds exposure) const {
  if (!incandescent_ || exposure.count() <= 0) return 1;
  const double omega = 2 * M_PI * 2 * profile_.mains_hz;
  // Phase from whole nanoseconds within a second: a week of cycles would cost its digits.
  const double t0 = toSeconds(begin % std::chrono::seconds(1)), t1 = t0 + toSeconds(exposure);
  return 1 + profile_.ripple / 2 * (std::sin(omega * t1) - std::sin(omega * t0)) /
                 (omega * toSeconds(exposure));
}

double Lamp::faultFactor(Nanoseconds begin, Nanoseconds end) const {
  double factor = 1;
  for (const Fault& fault : faults_) {
    const double share = overlap(fault, begin, end);
    if (fault.kind == FaultKind::kLampDead) factor *= 1 - share;
    if (fault.kind == FaultKind::kLampStep) factor *= 1 + fault.amount * share;
    if (fault.kind == FaultKind::kLampDrift && begin > fault.at)
      factor *= 1 + fault.amount * toSeconds(std::min(begin, endOf(fault)) - fault.at) / 86'400;
  }
  return std::max(factor, 0.0);
}

double Lamp::steadyLevelAt(Nanoseconds now) const {
  return set_ * (1 - profile_.warm_up * (1 - warmthAt(now))) * faultFactor(now, now);
}

double Lamp::levelOver(Nanoseconds begin, Nanoseconds exposure) const {
  if (set_ <= 0) return 0;
  const double warm = 1 - profile_.warm_up * (1 - warmthAt(begin + exposure / 2));
  const double noise =
      profile_.shot_to_shot *
      gaussian(hashSeed(seed_, static_cast<std::uint64_t>(begin.count()), 0x5b07ull));
  return set_ * warm * rippleOver(begin, exposure) * (1 + noise) *
         faultFactor(begin, begin + exposure);
}

}  // namespace patina::devices::twin
