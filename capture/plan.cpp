// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/plan.h"

#include <algorithm>

#include "capture/windows.h"
#include "devices/config_rect.h"
#include "processing/image/sha256.h"

namespace patina::capture {
namespace {

using devices::ConfigTable;
using namespace std::chrono_literals;

constexpr int kDegreeMost = 12;  // of polynomials in time
constexpr Nanoseconds kIntervalLeast = 50ms, kIntervalMost = 24h * 366;
constexpr Nanoseconds kDurationMost = 24h * 366 * 20;
constexpr Nanoseconds kExposureLeast = 1us, kExposureMost = 1h;
constexpr Nanoseconds kSensorsLeast = 1s, kSensorsMost = 24h;
constexpr std::int64_t kStepsMost = 1'000'000'000;
constexpr std::uint64_t kDiskReserveDefault = 64'000'000;  // the catalogue's room to tell its end

// "Z", "+02:00", "-05:30", or a duration: "2h", "-5h30min".
Nanoseconds takeUtcOffset(ConfigTable& table) {
  const std::string text = table.takeString("utc_offset", "Z");
  if (text == "Z") return Nanoseconds{0};
  const bool negative = text.starts_with('-');
  std::string size = text.substr(negative || text.starts_with('+') ? 1 : 0);
  if (size.size() == 5 && size[2] == ':') size = size.substr(0, 2) + "h" + size.substr(3) + "min";
  try {
    const Nanoseconds offset = parseDuration(size);
    if (offset <= std::chrono::hours(14)) return negative ? -offset : offset;
  } catch (const ProcessingError&) {
    // Told below, in the words of this key.
  }
  table.reject("utc_offset", "\"" + text + "\" is no offset from UTC (\"-14:00\" to \"+14:00\")");
}

// "06:30"; "24:00" is the end of the day.
Nanoseconds takeTimeOfDay(ConfigTable& table, const std::string& key) {
  const std::string text = table.takeString(key);
  const auto digit = [&](std::size_t i) { return text[i] >= '0' && text[i] <= '9'; };
  if (text.size() == 5 && text[2] == ':' && digit(0) && digit(1) && digit(3) && digit(4)) {
    const int minutes = ((text[0] - '0') * 10 + text[1] - '0') * 60;
    const int rest = (text[3] - '0') * 10 + text[4] - '0';
    if (rest < 60 && minutes + rest <= 24 * 60) return std::chrono::minutes(minutes + rest);
  }
  table.reject(key, "\"" + text + "\" is no time of day (\"00:00\" to \"24:00\")");
}

std::vector<Window> takeWindows(ConfigTable& table) {
  std::vector<Window> windows;
  for (ConfigTable& entry : table.takeTables("windows")) {
    Window w;
    w.from = takeTimeOfDay(entry, "from");
    w.to = takeTimeOfDay(entry, "to");
    entry.finish();
    if (w.from == w.to) entry.reject("to", "is the same as from: this window never opens");
    windows.push_back(w);
  }
  return windows;
}

devices::Exposure takeExposureTable(ConfigTable& entry) {
  devices::Exposure e;
  e.time = entry.takeExposure("time", kExposureLeast, kExposureMost);
  e.iso = Iso{entry.takeNumber("iso", 1, 10'000'000, e.iso.value)};
  e.f_number = FNumber{entry.takeNumber("f_number", 0.5, 128, e.f_number.value)};
  entry.finish();
  return e;
}

bool isListOfText(ConfigTable& table, const std::string& key) {
  try {
    table.takeStrings(key);
    return true;
  } catch (const devices::ConfigError&) {
    return false;
  }
}

// A list of texts ["1/50", "1/10"] or of tables [{time, iso, f_number}].
std::vector<devices::Exposure> takeExposures(ConfigTable& sweep) {
  if (!sweep.has("exposures"))
    sweep.reject("exposures", "is missing; must be a list such as [\"1/50\", \"1/10\"]");
  std::vector<devices::Exposure> exposures;
  if (isListOfText(sweep, "exposures")) {
    for (const std::string& text : sweep.takeStrings("exposures")) {
      devices::Exposure e;
      try {
        e.time = parseExposure(text);
      } catch (const Failure& failure) {
        sweep.reject("exposures", failure.what());
      }
      if (e.time < kExposureLeast || e.time > kExposureMost)
        sweep.reject("exposures", text + " is out of range (" + formatExposure(kExposureLeast) +
                                      " to " + formatExposure(kExposureMost) + ")");
      exposures.push_back(e);
    }
  } else {
    for (ConfigTable& entry : sweep.takeTables("exposures"))
      exposures.push_back(takeExposureTable(entry));
  }
  if (exposures.empty()) sweep.reject("exposures", "is empty: a sweep needs one at least");
  return exposures;
}

Sweep takeSweep(ConfigTable& table) {
  Sweep sweep;
  sweep.cameras = table.takeStrings("cameras", std::vector<std::string>{});
  sweep.lights = table.takeStringLists("lights");
  if (sweep.lights.empty())
    table.reject("lights", "is empty: name a state at least, as [[\"key\"]]; [[]] is all off");
  for (std::size_t i = 0; i < sweep.lights.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (devices::lightStateName(sweep.lights[i]) == devices::lightStateName(sweep.lights[k]))
        table.reject("lights",
                     "names the state " + devices::lightStateName(sweep.lights[i]) + " twice");
  sweep.exposures = takeExposures(table);
  table.finish();
  return sweep;
}

LightCheck takeLightCheck(ConfigTable& table, Nanoseconds interval) {
  LightCheck check;
  check.max_hold = interval;
  if (auto entry = table.takeTable("light_check")) {
    check.mode =
        entry->takeChoice("mode", {"controlled", "uncontrolled"}, "controlled") == "controlled"
            ? LightMode::kControlled
            : LightMode::kUncontrolled;
    check.band = entry->takeNumber("band", 0.001, 0.5, check.band);
    check.settle = entry->takeDuration("settle", Nanoseconds{0}, 1h, Nanoseconds{0});
    // A hold never outlives its slot: what is longer than the interval means "until the slot ends".
    check.max_hold = std::min(
        interval, entry->takeDuration("max_hold", Nanoseconds{0}, kIntervalMost, interval));
    entry->finish();
  }
  return check;
}

std::optional<Nanoseconds> takeSensors(ConfigTable& root) {
  auto sensors = root.takeTable("sensors");
  if (!sensors) return std::nullopt;
  const Nanoseconds every = sensors->takeDuration("every", kSensorsLeast, kSensorsMost);
  sensors->finish();
  return every;
}

void takeAfter(ConfigTable& after, Plan& plan) {
  plan.after = after.takeStrings("steps", std::vector<std::string>{});
  for (const std::string& step : plan.after)
    if (step != "ttf" && step != "film" && step != "brdf" && step != "stbrdf")
      after.reject("steps", "\"" + step + "\" is not one of ttf, film, brdf, stbrdf");
  plan.after_degree = static_cast<int>(after.takeInteger("degree", 0, kDegreeMost, 3));
  plan.after_bin = static_cast<int>(after.takeInteger("bin", 1, 64, 1));
  const std::string& model = plan.after_register = after.takeString("register", "");
  if (!model.empty() && model != "translation" && model != "euclidean" && model != "affine" &&
      model != "homography")
    after.reject("register",
                 "\"" + model + "\" is not one of translation, euclidean, affine, homography");
  if (after.has("fiducial")) {
    if (model.empty()) after.reject("fiducial", "goes with register = \"translation\"");
    plan.after_fiducial = devices::takeRect(after, "fiducial");
  }
  after.finish();
}

void takeDiskAfterAlerts(ConfigTable& root, Plan& plan) {
  plan.disk_reserve_bytes = kDiskReserveDefault;
  if (auto disk = root.takeTable("disk")) {
    const std::string text = disk->takeString("reserve", "64MB");
    try {
      plan.disk_reserve_bytes = parseBytes(text);
    } catch (const Failure& failure) {
      disk->reject("reserve", failure.what());
    }
    disk->finish();
  }
  if (auto after = root.takeTable("after")) takeAfter(*after, plan);
  plan.alerts = takeAlerts(root, plan.interval);
}

void checkSweepFits(const ConfigTable& root, const Plan& plan) {
  const Nanoseconds length = shortestSweep(plan);
  if (length > plan.interval)
    root.reject("interval", "the sweep takes " + formatDuration(length) +
                                " at least (exposures and settle times), longer than the interval "
                                "of " +
                                formatDuration(plan.interval));
}

}  // namespace

Plan parsePlan(const std::string& toml, const std::filesystem::path& source) {
  ConfigTable root = devices::ConfigFile::parse(toml, source);
  Plan plan;
  plan.toml = toml;
  plan.sha256 = sha256(std::string_view(toml)).hex();
  plan.source = source;
  plan.rig_file = root.takePath("rig");
  plan.specimen = root.takeId("specimen");
  plan.seed = static_cast<std::uint64_t>(root.takeInteger("seed", 0, INT64_MAX, 1));
  plan.interval = root.takeDuration("interval", kIntervalLeast, kIntervalMost);
  plan.duration = root.takeDuration("duration", kIntervalLeast, kDurationMost);
  if (plan.duration / plan.interval > kStepsMost)
    root.reject("duration", "makes more than " + std::to_string(kStepsMost) + " steps");
  if (root.has("start")) {
    try {
      plan.start_utc = parseUtc(root.takeString("start"));
    } catch (const ProcessingError& failure) {
      root.reject("start", failure.what());
    }
  }
  plan.utc_offset = takeUtcOffset(root);
  plan.windows = takeWindows(root);
  for (ConfigTable& table : root.takeTables("sweep")) plan.sweeps.push_back(takeSweep(table));
  plan.light_check = takeLightCheck(root, plan.interval);
  if (auto late = root.takeTable("late")) {
    late->takeChoice("policy", {"skip"}, "skip");
    late->finish();
  }
  plan.read_sensors_every = takeSensors(root);
  takeDiskAfterAlerts(root, plan);
  root.finish();
  if (plan.sweeps.empty())
    root.reject("sweep", "is missing; a plan needs one [[sweep]] at least, with lights, exposures");
  checkSweepFits(root, plan);
  return plan;
}

Plan readPlan(const std::filesystem::path& file) {
  return parsePlan(devices::ConfigFile::readText(file), file);
}

void checkAgainst(const Plan& plan, const devices::RigSpec& rig) {
  // Read once more only for the lines; the values are those of `plan`.
  ConfigTable root = devices::ConfigFile::parse(plan.toml, plan.source);
  auto tables = root.takeTables("sweep");
  const auto known = [](const auto& specs) {
    std::string text;
    for (const auto& s : specs) text += (text.empty() ? "" : ", ") + s.id;
    return text.empty() ? std::string("none") : text;
  };
  const auto has = [](const auto& specs, const std::string& id) {
    return std::any_of(specs.begin(), specs.end(), [&](const auto& s) { return s.id == id; });
  };
  if (rig.cameras.empty()) root.reject("rig", "the rig \"" + rig.name + "\" has no camera");
  for (std::size_t i = 0; i < plan.sweeps.size() && i < tables.size(); ++i) {
    for (const std::string& id : plan.sweeps[i].cameras)
      if (!has(rig.cameras, id))
        tables[i].reject("cameras", "the rig \"" + rig.name + "\" has no camera \"" + id +
                                        "\" (it has: " + known(rig.cameras) + ")");
    for (const auto& state : plan.sweeps[i].lights)
      for (const std::string& id : state)
        if (!has(rig.lights, id))
          tables[i].reject("lights", "the rig \"" + rig.name + "\" has no light \"" + id +
                                         "\" (it has: " + known(rig.lights) + ")");
  }
}

std::vector<std::string> camerasOf(const Sweep& sweep, const devices::RigSpec& rig) {
  if (!sweep.cameras.empty()) return sweep.cameras;
  std::vector<std::string> ids;
  for (const auto& camera : rig.cameras) ids.push_back(camera.id);
  return ids;
}

Nanoseconds shortestSweep(const Plan& plan) {
  Nanoseconds length{0};
  for (const Sweep& sweep : plan.sweeps)
    for (const auto& state : sweep.lights) {
      if (!state.empty()) length += plan.light_check.settle;
      for (const auto& e : sweep.exposures) length += e.time;
    }
  return length;
}

std::int64_t slotCount(const Plan& plan) {
  return (plan.duration.count() + plan.interval.count() - 1) / plan.interval.count();
}

std::int64_t stepCount(const Plan& plan, UtcTime t0) {
  const std::int64_t slots = slotCount(plan);
  if (plan.windows.empty()) return slots;
  std::int64_t count = 0;
  for (std::int64_t k = 0; k < slots; ++k)
    count += insideWindows(plan, t0 + k * plan.interval) ? 1 : 0;
  return count;
}

std::int64_t stepCount(const Plan& plan) {
  // Without a start the run is taken to begin at midnight of the plan's day.
  return stepCount(plan, plan.start_utc.value_or(UtcTime{} - plan.utc_offset));
}

int shotsAStep(const Plan& plan, const devices::RigSpec& rig) {
  int shots = 0;
  for (const Sweep& sweep : plan.sweeps)
    shots += static_cast<int>(camerasOf(sweep, rig).size() * sweep.lights.size() *
                              sweep.exposures.size());
  return shots;
}

int shotsAStep(const Plan& plan) {
  int shots = 0;
  for (const Sweep& sweep : plan.sweeps)
    shots += static_cast<int>(std::max<std::size_t>(sweep.cameras.size(), 1) * sweep.lights.size() *
                              sweep.exposures.size());
  return shots;
}

bool isFedBySteps(const Plan& plan) {
  if (!plan.after_register.empty()) return false;  // poses hang together from the first frame on
  return std::ranges::any_of(
      plan.after, [](const std::string& step) { return step == "brdf" || step == "stbrdf"; });
}

}  // namespace patina::capture
