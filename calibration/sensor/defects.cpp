// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/defects.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>
#include <unordered_map>

namespace patina::calibration {
namespace {

constexpr std::size_t kNeighbours = 8;
constexpr int kReachMax = 4;             // texels aside, for neighbours that measure
constexpr std::size_t kEnough = 3;       // neighbours; with fewer, one looks further
constexpr double kShareMax = 0.01;       // of all pixels
constexpr double kNormalOfMad = 1.4826;  // standard deviation over median absolute deviation

using Place = std::pair<int, int>;

[[noreturn]] void refuse(const std::string& what) {
  throw CalibrationError(Exit::kBadData, "defects: " + what);
}

// Offsets of the same colour within `reach`, nearest first.
std::vector<Place> offsetsOf(const ColourFilters& filters, int x, int y, int reach) {
  std::vector<Place> out;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx)
      if ((dx != 0 || dy != 0) &&
          colourAt(filters, x + dx + 8, y + dy + 8) == colourAt(filters, x, y))
        out.emplace_back(dx, dy);
  std::stable_sort(out.begin(), out.end(), [](const Place& a, const Place& b) {
    return a.first * a.first + a.second * a.second < b.first * b.first + b.second * b.second;
  });
  return out;
}

float medianOf(float* values, std::size_t count) {
  std::sort(values, values + count);
  return count % 2 == 1 ? values[count / 2] : (values[count / 2 - 1] + values[count / 2]) / 2;
}

// Median and robust sigma of one colour.
struct Spread {
  double median = 0, sigma = 0;
};
Spread spreadOf(std::vector<float> values) {
  if (values.empty()) return {};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const float median = *middle;
  for (float& v : values) v = std::abs(v - median);
  std::nth_element(values.begin(), middle, values.end());
  return {median, kNormalOfMad * *middle};
}

void findHot(const DarkOf& dark, const ColourFilters& filters, const DefectOptions& options,
             FoundDefects& out) {
  const double seconds = toSeconds(dark.exposure);
  if (!(seconds > 0)) refuse("the dark has no exposure: give --exposure-time");
  const ImageView<const float> in = dark.dark;
  const int colours = in.channels == 1 ? 3 : in.channels;
  for (int c = 0; c < colours; ++c) {
    std::vector<float> values;
    const auto each = [&](const auto& body) {
      for (int y = 0; y < in.height; ++y)
        for (int x = 0; x < in.width; ++x)
          if (in.channels > 1)
            body(x, y, in.at(x, y, c));
          else if (colourAt(filters, x, y) == c)
            body(x, y, in.at(x, y));
    };
    each([&](int, int, float v) { values.push_back(v); });
    const Spread spread = spreadOf(std::move(values));
    const double limit = std::max(options.hot_least, options.hot_sigmas * spread.sigma);
    each([&](int x, int y, float v) {
      const double excess = v - spread.median;
      if (excess <= limit) return;
      out.map.defects.push_back({x, y, DefectKind::kHot, excess / seconds});
      ++out.report.hot;
    });
  }
}

void findUnresponsive(ImageView<const float> flat, const ColourFilters& filters,
                      const DefectOptions& options, FoundDefects& out) {
  std::array<std::vector<Place>, 4> offsets;
  for (int i = 0; i < 4; ++i) {
    offsets[i] = offsetsOf(filters, i % 2, i / 2, 2);
    if (offsets[i].size() > kNeighbours) offsets[i].resize(kNeighbours);
  }
  std::mutex mutex;
  const auto row = [&](int y) {
    for (int x = 0; x < flat.width; ++x) {
      for (int c = 0; c < flat.channels; ++c) {
        float near[kNeighbours];
        std::size_t count = 0;
        for (const auto& [dx, dy] : offsets[(y & 1) * 2 + (x & 1)])
          if (x + dx >= 0 && y + dy >= 0 && x + dx < flat.width && y + dy < flat.height)
            near[count++] = flat.at(x + dx, y + dy, c);
        if (count == 0) continue;
        const double response = flat.at(x, y, c) / std::max(1e-6f, medianOf(near, count));
        if (response >= options.dim && response <= options.bright) continue;
        const DefectKind kind = response < options.dead  ? DefectKind::kDead
                                : response < options.dim ? DefectKind::kDim
                                                         : DefectKind::kBright;
        const std::lock_guard lock(mutex);
        out.map.defects.push_back({x, y, kind, response});
        break;
      }
    }
  };
  tbb::parallel_for(0, flat.height, row);
  for (const Defect& defect : out.map.defects) {
    out.report.dead += defect.kind == DefectKind::kDead;
    out.report.dim += defect.kind == DefectKind::kDim;
    out.report.bright += defect.kind == DefectKind::kBright;
  }
}

// Groups of defects that are neighbours of their colour.
void countClusters(const DefectMap& map, const ColourFilters& filters, DefectReport& report) {
  const auto key = [](int x, int y) { return (static_cast<std::int64_t>(y) << 32) | x; };
  std::unordered_map<std::int64_t, bool> seen;
  for (const Defect& defect : map.defects) seen[key(defect.x, defect.y)] = false;
  for (const Defect& defect : map.defects) {
    int members = 0;
    std::vector<Place> open{{defect.x, defect.y}};
    while (!open.empty()) {
      const auto [x, y] = open.back();
      open.pop_back();
      const auto at = seen.find(key(x, y));
      if (at == seen.end() || at->second) continue;
      at->second = true;
      ++members;
      const int reach = filters == kOneColour ? 1 : 2;
      for (const auto& [dx, dy] : offsetsOf(filters, x, y, reach))
        if (x + dx >= 0 && y + dy >= 0) open.emplace_back(x + dx, y + dy);
    }
    report.clusters += members > 1;
    report.largest_cluster = std::max(report.largest_cluster, members);
  }
}

}  // namespace

void DefectOptions::check() const {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw CalibrationError(Exit::kUsage, std::string("defects: ") + what);
  };
  require(hot_sigmas >= 3 && hot_sigmas <= 100, "hot_sigmas must lie in [3, 100]");
  require(hot_least >= 0 && hot_least <= 1, "hot_least must lie in [0, 1]");
  require(dead >= 0 && dead <= dim && dim < 1 && bright > 1, "dead <= dim < 1 < bright is needed");
}

FoundDefects findDefects(const std::optional<DarkOf>& dark,
                         const std::optional<ImageView<const float>>& flat,
                         const ColourFilters& filters, const DefectOptions& options) {
  options.check();
  if (!dark && !flat)
    throw CalibrationError(Exit::kUsage, "defects: a dark or a flat is needed to find them in");
  FoundDefects out;
  out.map.size = dark ? dark->dark.size() : flat->size();
  if (flat && flat->size() != out.map.size) refuse("dark and flat differ in size");
  if (dark) {
    out.map.temperature_c = dark->temperature_c;
    findHot(*dark, filters, options, out);
  }
  if (flat) findUnresponsive(*flat, filters, options, out);
  const auto pixels = static_cast<double>(out.map.size.width) * out.map.size.height;
  if (static_cast<double>(out.map.defects.size()) > kShareMax * pixels)
    refuse(std::to_string(out.map.defects.size()) +
           " pixels are defective, more than 1 % of all: that is no dark or no flat");
  std::sort(out.map.defects.begin(), out.map.defects.end(), [](const Defect& a, const Defect& b) {
    return std::tuple(a.y, a.x, a.kind) < std::tuple(b.y, b.x, b.kind);
  });
  countClusters(out.map, filters, out.report);
  return out;
}

std::vector<Defect> defectsThatMatter(const DefectMap& map, Nanoseconds exposure,
                                      double temperature_c, const HotLimit& limit) {
  const double gathered =
      toSeconds(exposure) * std::exp2((temperature_c - map.temperature_c) / limit.doubling_k);
  std::vector<Defect> out;
  for (const Defect& defect : map.defects)
    if (defect.kind != DefectKind::kHot || defect.strength * gathered >= limit.least)
      out.push_back(defect);
  return out;
}

std::vector<Repair> repairsOf(const std::vector<Defect>& defects, SizePx size,
                              const ColourFilters& filters) {
  const auto key = [](int x, int y) { return (static_cast<std::int64_t>(y) << 32) | x; };
  std::unordered_map<std::int64_t, bool> bad;
  for (const Defect& defect : defects) bad[key(defect.x, defect.y)] = false;
  std::vector<Repair> repairs;
  for (const Defect& defect : defects) {
    if (std::exchange(bad[key(defect.x, defect.y)], true)) continue;
    Repair one{defect.x, defect.y, {}};
    for (int reach = 1; reach <= kReachMax && one.from.size() < kEnough; ++reach) {
      one.from.clear();
      for (const auto& [dx, dy] : offsetsOf(filters, defect.x, defect.y, reach)) {
        const int x = defect.x + dx, y = defect.y + dy;
        if (x < 0 || y < 0 || x >= size.width || y >= size.height) continue;
        if (!bad.contains(key(x, y)) && one.from.size() < kNeighbours) one.from.emplace_back(x, y);
      }
    }
    repairs.push_back(std::move(one));
  }
  return repairs;
}

void repair(ImageView<float> frame, const std::vector<Repair>& repairs) {
  for (const Repair& one : repairs)
    for (int c = 0; c < frame.channels && !one.from.empty(); ++c) {
      float near[kNeighbours];
      std::size_t count = 0;
      for (const auto& [x, y] : one.from) near[count++] = frame.at(x, y, c);
      frame.at(one.x, one.y, c) = medianOf(near, count);
    }
}

}  // namespace patina::calibration
