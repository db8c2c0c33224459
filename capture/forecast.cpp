// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/forecast.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace patina::capture {
namespace {

// Rows of the catalogue and lines of the journal, measured: a step with one shot, one frame and
// three light verdicts.
constexpr std::int64_t kBytesAStep = 600, kBytesAShot = 1000, kBytesACheck = 500;
constexpr std::int64_t kBytesAReading = 350;

template <class T>
const T* byId(const std::vector<T>& list, const std::string& id) {
  const auto found = std::find_if(list.begin(), list.end(), [&](const T& t) { return t.id == id; });
  return found == list.end() ? nullptr : &*found;
}

bool hasPatch(const devices::RigSpec& rig, const std::string& camera) {
  return std::any_of(rig.patches.begin(), rig.patches.end(),
                     [&](const auto& p) { return p.camera == camera; });
}

// How long one light state is on for one exposure: the slowest camera's cycle counts.
Nanoseconds groupTime(const std::vector<std::string>& cameras, const devices::Exposure& exposure,
                      const ForecastInputs& inputs) {
  Nanoseconds longest = exposure.time;
  for (const std::string& id : cameras)
    if (const auto* caps = byId(inputs.cameras, id))
      longest = std::max(longest, exposure.time + caps->cycle);
  return longest;
}

void countShots(const Plan& plan, const devices::RigSpec& rig, const ForecastInputs& inputs,
                Forecast& out) {
  std::int64_t checks = 0;
  for (const Sweep& sweep : plan.sweeps) {
    const auto cameras = camerasOf(sweep, rig);
    const auto lit = std::count_if(sweep.lights.begin(), sweep.lights.end(),
                                   [](const auto& state) { return !state.empty(); });
    const auto each = static_cast<std::int64_t>(sweep.lights.size() * sweep.exposures.size());
    for (const std::string& id : cameras) {
      out.shots += each * out.steps;
      if (hasPatch(rig, id))
        checks += 3 * lit * static_cast<std::int64_t>(sweep.exposures.size()) * out.steps;
      const auto* caps = byId(inputs.cameras, id);
      if (!caps) continue;
      out.frame_bytes += each * out.steps * caps->bytes_a_shot;
      if (caps->has_shutter) out.actuations[id] += each * out.steps;
    }
  }
  std::int64_t rounds = out.steps;
  if (plan.read_sensors_every) rounds += plan.duration / *plan.read_sensors_every;
  out.readings = rounds * static_cast<std::int64_t>(rig.sensors.size());
  out.catalogue_bytes = out.steps * kBytesAStep + out.shots * kBytesAShot + checks * kBytesACheck +
                        out.readings * kBytesAReading;
}

void countTimes(const Plan& plan, const devices::RigSpec& rig, const ForecastInputs& inputs,
                Forecast& out) {
  std::map<std::string, Nanoseconds> on_a_step;
  for (const Sweep& sweep : plan.sweeps) {
    const auto cameras = camerasOf(sweep, rig);
    for (const auto& state : sweep.lights) {
      Nanoseconds on = state.empty() ? Nanoseconds{0} : plan.light_check.settle;
      for (const auto& exposure : sweep.exposures) on += groupTime(cameras, exposure, inputs);
      out.sweep += on;
      for (const std::string& id : state) on_a_step[id] += on;
    }
  }
  const double run_hours = toSeconds(out.end - out.begin) / 3600;
  for (const auto& light : rig.lights) {
    const double lit = toSeconds(on_a_step[light.id]) * static_cast<double>(out.steps) / 3600;
    // A lamp that stays on in between is off only while states without it are shot. One that is
    // kept rests as a sweep ends.
    const auto& last = plan.sweeps.back().lights.back();
    const bool stays_on = light.between == devices::Between::kOn ||
                          (light.between == devices::Between::kKeep &&
                           std::find(last.begin(), last.end(), light.id) != last.end());
    const double dark =
        toSeconds(out.sweep - on_a_step[light.id]) * static_cast<double>(out.steps) / 3600;
    out.lamp_hours[light.id] = stays_on ? std::max(lit, run_hours - dark) : lit;
  }
}

void warnOfRipple(const Plan& plan, const ForecastInputs& inputs, Forecast& out) {
  std::set<std::string> said;
  for (const Sweep& sweep : plan.sweeps)
    for (const auto& state : sweep.lights)
      for (const std::string& id : state) {
        const auto* lamp = byId(inputs.lights, id);
        if (!lamp || !lamp->incandescent) continue;
        for (const auto& exposure : sweep.exposures) {
          const double halves = toSeconds(exposure.time) * 2 * lamp->mains_hz;
          if (std::abs(halves - std::round(halves)) <= 0.005 && halves >= 0.995) continue;
          const std::string text = "exposure " + formatExposure(exposure.time) +
                                   " under incandescent light " + id +
                                   " is no whole number of mains half-periods (1/" +
                                   std::to_string(static_cast<int>(2 * lamp->mains_hz)) +
                                   " s): the beat looks like the fault the light check watches for";
          if (said.insert(text).second) out.warnings.push_back(text);
        }
      }
}

void warnOfTime(const Plan& plan, const devices::RigSpec& rig, const ForecastInputs& inputs,
                Forecast& out) {
  for (const Sweep& sweep : plan.sweeps)
    for (const std::string& id : camerasOf(sweep, rig)) {
      const auto* caps = byId(inputs.cameras, id);
      if (!caps) continue;
      if (caps->cycle > plan.interval)
        out.warnings.push_back("interval " + formatDuration(plan.interval) +
                               " is shorter than the cycle of camera " + id + " (" +
                               formatDuration(caps->cycle) + "): every other step will be skipped");
      for (const auto& exposure : sweep.exposures)
        if (exposure.time < caps->exposure_min || exposure.time > caps->exposure_max)
          out.warnings.push_back("camera " + id + " cannot expose " +
                                 formatExposure(exposure.time) + " (" +
                                 formatExposure(caps->exposure_min) + " to " +
                                 formatExposure(caps->exposure_max) + ")");
    }
  if (out.sweep > plan.interval)
    out.warnings.push_back("the sweep takes " + formatDuration(out.sweep) +
                           " with the cameras' cycles, longer than the interval of " +
                           formatDuration(plan.interval));
  else if (out.sweep * 10 > plan.interval * 9)
    out.warnings.push_back("the sweep takes " + formatDuration(out.sweep) + " of the interval's " +
                           formatDuration(plan.interval) + ": no time is left for a second try");
}

void warnOfDisk(const Plan& plan, const ForecastInputs& inputs, Forecast& out) {
  const std::int64_t bytes = out.frame_bytes + out.catalogue_bytes;
  if (!inputs.free_bytes || out.steps == 0) return;
  const DiskUse use{*inputs.free_bytes,
                    plan.disk_reserve_bytes,
                    static_cast<double>(bytes) / static_cast<double>(out.steps),
                    out.steps,
                    out.begin,
                    out.end};
  out.disk_full = diskFullAt(use);
  if (!out.disk_full) return;
  out.warnings.push_back(
      "the disk is too small: " + formatBytes(static_cast<std::uint64_t>(bytes)) +
      " and a reserve of " + formatBytes(plan.disk_reserve_bytes) + " are needed, " +
      formatBytes(*inputs.free_bytes) + " are free: captures stop about " +
      formatUtc(*out.disk_full).substr(0, 19) + ", after " + std::to_string(stepsThatFit(use)) +
      " of " + std::to_string(out.steps) + " steps");
}

void warnOfSteps(const Plan& plan, const devices::RigSpec& rig, const ForecastInputs& inputs,
                 Forecast& out) {
  if (out.steps == 0)
    out.warnings.push_back("no step falls into a window of the day: nothing will be captured");
  else if (!plan.windows.empty() && plan.interval > std::chrono::hours(1))
    for (const Window& w : plan.windows) {
      const Nanoseconds open =
          w.from < w.to ? w.to - w.from : w.to - w.from + std::chrono::hours(24);
      if (open < plan.interval)
        out.warnings.push_back("a window of " + formatDuration(open) +
                               " is shorter than the interval: some days may have no step");
    }
  if (plan.read_sensors_every && rig.sensors.empty())
    out.warnings.emplace_back("the plan reads sensors every " +
                              formatDuration(*plan.read_sensors_every) +
                              ", but the rig has no [[sensor]]");
  warnOfDisk(plan, inputs, out);
  if (plan.light_check.mode == LightMode::kUncontrolled) return;
  const bool lux = std::any_of(rig.sensors.begin(), rig.sensors.end(), [](const auto& s) {
    return s.quantity == devices::Quantity::kIlluminance;
  });
  std::set<std::string> unwatched;
  for (const Sweep& sweep : plan.sweeps) {
    const auto cameras = camerasOf(sweep, rig);
    const bool patch = std::any_of(cameras.begin(), cameras.end(),
                                   [&](const std::string& id) { return hasPatch(rig, id); });
    for (const auto& state : sweep.lights)
      if (!state.empty() && !patch && !lux) unwatched.insert(devices::lightStateName(state));
  }
  for (const std::string& state : unwatched)
    out.warnings.push_back("nothing watches the light state " + state +
                           ": no reference patch and no lux sensor");
}

}  // namespace

std::int64_t stepsThatFit(const DiskUse& use) {
  if (use.free_bytes <= use.reserve_bytes) return 0;
  if (!(use.bytes_a_step > 0)) return use.steps_left;
  const double fit = static_cast<double>(use.free_bytes - use.reserve_bytes) / use.bytes_a_step;
  return fit >= static_cast<double>(use.steps_left) ? use.steps_left
                                                    : static_cast<std::int64_t>(fit);
}

std::optional<UtcTime> diskFullAt(const DiskUse& use) {
  const std::int64_t fit = stepsThatFit(use);
  if (fit >= use.steps_left) return std::nullopt;
  const double share = static_cast<double>(fit) / static_cast<double>(use.steps_left);
  const auto rest = static_cast<double>((use.end - use.next_due).count());
  return use.next_due + Nanoseconds{static_cast<std::int64_t>(share * rest)};
}

Forecast forecast(const Plan& plan, const devices::RigSpec& rig, const ForecastInputs& inputs) {
  Forecast out;
  out.begin = plan.start_utc.value_or(inputs.begin);
  out.end = out.begin + plan.duration;
  out.steps = stepCount(plan, out.begin);
  countShots(plan, rig, inputs, out);
  countTimes(plan, rig, inputs, out);
  warnOfRipple(plan, inputs, out);
  warnOfTime(plan, rig, inputs, out);
  warnOfSteps(plan, rig, inputs, out);
  return out;
}

}  // namespace patina::capture
