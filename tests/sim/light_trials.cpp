// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/sim/light_trials.h"

#include <cmath>

#include "devices/twin/profile.h"
#include "processing/image/random.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using capture::GateVerdict;

constexpr Nanoseconds kWarm = 1h;  // lamps burn before the first shot
constexpr Nanoseconds kExposure = 20ms;
constexpr int kTileSide_px = 32;
constexpr std::array<double, 3> kChannel{0.7, 1.0, 0.8};          // of the patch's level
constexpr std::array<double, 3> kShareOfPixels{0.25, 0.5, 0.25};  // of an RGGB mosaic
const UtcTime kStart = parseUtc("2024-05-01");

devices::LightSpec lampNamed(const std::string& id) {
  devices::LightSpec spec;
  spec.id = id;
  spec.between = devices::Between::kOn;
  return spec;
}

devices::FaultPlan planOf(const LightTrial& t) {
  devices::FaultPlan plan;
  devices::Fault fault;
  fault.device = "key";
  fault.amount = t.size;
  fault.duration = devices::kFaultForEver;
  fault.at = kWarm + t.quiet_shots * t.interval - t.interval / 2;
  if (t.fault == LightFault::kStep) fault.kind = devices::FaultKind::kLampStep;
  if (t.fault == LightFault::kDead) fault.kind = devices::FaultKind::kLampDead;
  if (t.fault == LightFault::kDrift) {
    fault.kind = devices::FaultKind::kLampDrift;
    fault.at = {};
  }
  if (fault.kind != devices::FaultKind::kHang) plan.faults.push_back(fault);
  return plan;
}

// Of a pixel at a share of full scale: photons, readout and its own response.
double pixelNoise(double level) {
  const auto& sensor = devices::twin::referenceProfile().sensor;
  const double electrons = std::max(level * sensor.full_well, 1.0);
  return std::sqrt(electrons + sensor.read_noise * sensor.read_noise) / electrons;
}

// Red up and blue down, green so that the luminance stays, until u'v' moved by `size`.
std::array<double, 3> colourOf(double size) {
  double low = 0, high = 0.5;
  std::array<double, 3> ratio{};
  for (int i = 0; i < 40; ++i) {
    const double d = (low + high) / 2;
    ratio = {1 + d, 1 - 0.2126 / 0.7152 * d + 0.0722 / 0.7152 * d, 1 - d};
    const bool far =
        distance(calibration::chromaticity(ratio), calibration::chromaticity({1, 1, 1})) > size;
    (far ? high : low) = d;
  }
  return ratio;
}

bool isRight(LightFault fault, double size, const GateVerdict& v, const std::string& doubt) {
  const auto has = [&](const char* text) {
    return v.changed.find(text) != std::string::npos || v.reason.find(text) != std::string::npos;
  };
  const auto verdict = [&](const std::string& source, const char* is) {
    for (const auto& row : v.rows)
      if (row.source.starts_with(source) && row.verdict == is) return true;
    return false;
  };
  switch (fault) {
    case LightFault::kStep:
      return std::abs(size) > 0.025 ? v.blocks : v.blocks || has("stepped");
    case LightFault::kDead:
      return v.blocks;
    case LightFault::kRipple:
      return v.blocks || has("flickers") || has("stepped");
    case LightFault::kColour:
      return v.blocks || has("colour") || has("stepped");
    case LightFault::kShadow:
      return verdict("content:", "at_odds") && !v.blocks;
    case LightFault::kSoiled:
      return verdict("patch:", "covered") && !v.blocks;
    case LightFault::kStuck:
      return !doubt.empty();
    case LightFault::kLampSwap:
      return v.blocks && has("wrong lamp");
    case LightFault::kNone:
    case LightFault::kDrift:
      break;
  }
  return false;
}

}  // namespace

const char* name(LightFault fault) {
  constexpr const char* kNames[] = {"none",   "step",   "drift",  "dead lamp", "ripple",
                                    "colour", "shadow", "soiled", "stuck lux", "lamp swap"};
  return kNames[static_cast<std::size_t>(fault)];
}

LightSeriesMaker::LightSeriesMaker(const LightTrial& trial)
    : trial_(trial), faults_(planOf(trial)) {
  for (const char* id : {"key", "fill"})
    lamps_.emplace_back(lampNamed(id), false, devices::twin::referenceProfile().lamp, faults_,
                        trial.seed, kWarm);
  for (auto& lamp : lamps_) lamp.set(1, kWarm);
  for (std::uint64_t i = 0; i < 256; ++i) {
    albedo_.push_back(0.1 + 0.5 * uniform(hashSeed(trial.seed, i, 1)));
    change_a_day_.push_back(0.3 * uniform(hashSeed(trial.seed, i, 2)));
  }
  if (trial.fault == LightFault::kColour) colour_ = colourOf(trial.size);
}

Nanoseconds LightSeriesMaker::at(int shot) const { return kWarm + shot * trial_.interval; }

double LightSeriesMaker::draw(int shot, std::uint64_t what) const {
  return gaussian(hashSeed(trial_.seed, static_cast<std::uint64_t>(shot), what));
}

double LightSeriesMaker::trueLevel(int shot) const {
  return lamps_[0].levelOver(at(shot), kExposure);
}

const devices::twin::Lamp& LightSeriesMaker::lampOf(int shot, const std::string& state) const {
  const bool swapped = trial_.fault == LightFault::kLampSwap && faulty(shot);
  return lamps_[(state == "fill") != swapped ? 1 : 0];
}

capture::PatchSample LightSeriesMaker::patch(int shot, double level) const {
  const auto& profile = devices::twin::referenceProfile();
  const double grey =
      profile.sensor.grey_fill * profile.patch.reflectance / profile.sensor.grey_reflectance;
  const double pixels = profile.patch.side_px * profile.patch.side_px;
  const bool soiled = trial_.fault == LightFault::kSoiled && faulty(shot);
  capture::PatchSample p;
  p.camera = "cam0";
  p.level.channels = 3;
  for (std::size_t c = 0; c < 3; ++c) {
    const double share = grey * kChannel[c] * level * (soiled ? 1 - trial_.size : 1) *
                         (trial_.fault == LightFault::kColour && faulty(shot) ? colour_[c] : 1);
    const double pixel = pixelNoise(share);
    p.level.noise[c] = pixel / std::sqrt(pixels * kShareOfPixels[c]);
    p.level.level[c] = share * (1 + p.level.noise[c] * draw(shot, 10 + c));
    p.level.spread[c] = std::hypot(pixel, profile.sensor.prnu);
  }
  return p;
}

// A specimen that changes at its own pace, by up to 30 % a day; a sixth of it in the shadow.
calibration::TileLevels LightSeriesMaker::tiles(int shot, double level, bool fill_lit) const {
  calibration::TileLevels t{calibration::kTileColumns, calibration::kTileRows, {}};
  t.level.reserve(256);
  // Tiles by the million: their noise is drawn from a table of normal numbers.
  static const std::vector<double> table = [] {
    std::vector<double> numbers;
    for (std::uint64_t i = 0; i < 8192; ++i) numbers.push_back(gaussian(hashSeed(i, 99)));
    return numbers;
  }();
  const std::uint64_t shot_key = hashSeed(trial_.seed, static_cast<std::uint64_t>(shot), 1000);
  const double days = toSeconds(at(shot)) / 86400;
  const bool shadow = trial_.fault == LightFault::kShadow && faulty(shot);
  const bool coloured = trial_.fault == LightFault::kColour && faulty(shot);
  const double tint = coloured ? (colour_[0] + 2 * colour_[1] + colour_[2]) / 4 : 1;
  const double slope = trial_.fault == LightFault::kLampSwap ? trial_.size * 0.85 : 0.1;
  for (std::size_t i = 0; i < 256; ++i) {
    const double across = (static_cast<double>(i % 16) - 7.5) / 7.5;
    const double albedo = albedo_[i] / (1 + change_a_day_[i] * days);
    const double shading = 1 + (fill_lit ? slope : -slope) * across;
    const double shaded = shadow && i >= 100 && i < 143 ? 1 - trial_.size : 1;
    const double share = 0.9 * albedo * shading * shaded * level * tint;
    const double noise = pixelNoise(share) / kTileSide_px;
    const std::uint64_t key = hashSeed(shot_key, i);
    t.level.push_back(static_cast<float>(share * (1 + noise * table[key % table.size()])));
  }
  return t;
}

double LightSeriesMaker::lux(int shot, const devices::twin::Lamp& lamp) const {
  const auto& profile = devices::twin::referenceProfile();
  const bool stuck = trial_.fault == LightFault::kStuck && faulty(shot);
  const int seen = stuck ? trial_.quiet_shots : shot;
  return profile.lamp.illuminance_lux * lamp.steadyLevelAt(at(seen)) *
         (1 + profile.room.lux_noise * draw(seen, 20));
}

capture::SensorSample LightSeriesMaker::rest(int shot) const {
  capture::SensorSample s;
  s.id = "lux0";
  // Stuck before the rest of the first shot it touches.
  if (trial_.fault == LightFault::kStuck && faulty(shot)) s.reading.value = lux(shot, lamps_[0]);
  return s;
}

capture::LightSample LightSeriesMaker::shoot(int shot, const std::string& state) {
  const devices::twin::Lamp& lamp = lampOf(shot, state);
  double level = lamp.levelOver(at(shot), kExposure);
  if (trial_.fault == LightFault::kRipple && faulty(shot))
    level *= 1 + trial_.size *
                     std::cos(2 * M_PI *
                              uniform(hashSeed(trial_.seed, static_cast<std::uint64_t>(shot), 30)));
  capture::LightSample s;
  s.step_id = shot;
  s.light_state = state;
  s.utc = kStart + at(shot);
  s.patches = {patch(shot, level)};
  s.contents = {{"cam0", tiles(shot, level, &lamp == &lamps_[1]), std::nullopt}};
  capture::SensorSample l;
  l.id = "lux0";
  l.reading.value = lux(shot, lamp);
  s.sensors = {l};
  return s;
}

LightOutcome tryLight(const LightTrial& trial) {
  LightSeriesMaker maker(trial);
  capture::LightGate gate({}, {}, "trial");
  capture::SensorWatch watch;
  LightOutcome out;
  const bool two = trial.fault == LightFault::kLampSwap;
  for (int shot = 0; shot < trial.quiet_shots + trial.faulty_shots; ++shot) {
    watch.atRest(maker.rest(shot), {});
    for (const char* state : {"key", "fill"}) {
      if (!two && state == std::string("fill")) continue;
      const capture::LightSample sample = maker.shoot(shot, state);
      const GateVerdict v = gate.judge(sample);
      watch.duringShot(sample.sensors[0], state, {state}, true);
      const std::string doubt = watch.doubt("lux0");
      if (!v.blocks && v.changed.empty() && v.reason.empty() && doubt.empty()) continue;
      if (shot < trial.quiet_shots) {
        ++out.false_alarms;
        out.said = v.reason + v.changed + doubt;
        continue;
      }
      out.delay_shots = shot - trial.quiet_shots + 1;
      out.right = isRight(trial.fault, trial.size, v, doubt);
      out.said = v.reason + v.changed + doubt;
      return out;
    }
  }
  return out;
}

DriftOutcome tryDrift(const LightTrial& trial, int shots) {
  LightSeriesMaker maker(trial);
  capture::LightGate gate({}, {}, "trial");
  std::vector<double> left;
  DriftOutcome out;
  out.shots = shots;
  for (int shot = 0; shot < shots; ++shot) {
    const GateVerdict v = gate.judge(maker.shoot(shot, "key"));
    out.alarms += v.blocks || !v.changed.empty() || !v.reason.empty() ? 1 : 0;
    if (v.rows[1].baseline > 0) left.push_back(v.rows[1].gain * maker.trueLevel(shot));
    out.corrected += v.rows[1].verdict == "correct" ? 1 : 0;
  }
  double mean = 0;
  for (const double level : left) mean += level / static_cast<double>(left.size());
  const std::size_t tenth = left.size() / 10;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const double error = left[i] / mean - 1;
    out.rms += error * error / static_cast<double>(left.size());
    if (i >= left.size() - tenth) out.bias_end += error / static_cast<double>(tenth);
  }
  out.rms = std::sqrt(out.rms);
  return out;
}

}  // namespace patina::testing
