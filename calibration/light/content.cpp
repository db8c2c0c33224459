// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/light/content.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "calibration/failure.h"

namespace patina::calibration {
namespace {

constexpr int kSamplesAcross = 32;   // of a tile, either way
constexpr double kToSigma = 1.2533;  // from a mean absolute deviation, were it normal
constexpr float kLeastDeviation = 0.002f;
constexpr double kLeastRms = 0.01;                       // of tiles, relative: less is noise
constexpr double kForgotten = 0.97;                      // of what is usual, with every shot
constexpr double kPaceWeight = 0.6, kTrendWeight = 0.3;  // of the specimen's common pace
constexpr double kSudden = 0.02;                         // beyond this a pace is a shock ...
constexpr double kQuickening = 3;    // ... but for so many times what the last shot was off by
constexpr double kOfTheTiles = 0.1;  // of the tiles' own usual change, their median may be off by
constexpr double kOfTheLast = 0.3;   // ... and of what the last shot was off by, the next one
constexpr float kMostSurprise = 4;   // deviations that one shot may add to a tile's own

struct Grid {
  int columns, rows;
  RectPx tile(int column, int row, SizePx size) const {
    const int x0 = size.width * column / columns, x1 = size.width * (column + 1) / columns;
    const int y0 = size.height * row / rows, y1 = size.height * (row + 1) / rows;
    return {x0, y0, x1 - x0, y1 - y0};
  }
};

// Tiles of 4x4 pixels at least, so that each has whole cells of a mosaic.
Grid gridOf(SizePx size) {
  return {std::min(kTileColumns, size.width / 4), std::min(kTileRows, size.height / 4)};
}

bool touch(RectPx a, RectPx b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

template <class MeanOf>
TileLevels measure(SizePx size, RectPx patch, const MeanOf& mean) {
  const Grid grid = gridOf(size);
  TileLevels tiles{grid.columns, grid.rows, {}};
  tiles.level.reserve(static_cast<std::size_t>(grid.columns) * grid.rows);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const RectPx tile = grid.tile(column, row, size);
      tiles.level.push_back(touch(tile, patch) ? 0.0f : static_cast<float>(mean(tile)));
    }
  return tiles;
}

float logOf(float level) { return std::log(std::max(level, 1e-6f)); }

std::optional<double> medianOf(std::vector<float>& values) {
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool fits(const ContentSeries& series, const TileLevels& tiles) {
  return series.columns == tiles.columns && series.rows == tiles.rows &&
         series.forecast.size() == tiles.level.size();
}

bool isLit(const ContentSeries& series, const TileLevels& tiles, std::size_t tile,
           const ContentOptions& o) {
  return tiles.level[tile] > 0 && series.forecast[tile] > std::log(o.dark_level);
}

bool isUnseen(const ContentSeries& series, UtcTime utc, const ContentOptions& o) {
  return series.last_utc && series.usual_gap_s > 0 &&
         toSeconds(utc - *series.last_utc) > o.gap_intervals * series.usual_gap_s;
}

// What each tile differs by from its forecast; none where there is no light or the patch.
using Innovations = std::vector<std::optional<float>>;
Innovations innovationsOf(const ContentSeries& series, const TileLevels& tiles,
                          const ContentOptions& o) {
  Innovations innovations(tiles.level.size());
  for (std::size_t i = 0; i < tiles.level.size(); ++i)
    if (isLit(series, tiles, i, o)) innovations[i] = logOf(tiles.level[i]) - series.forecast[i];
  return innovations;
}

std::optional<double> commonOf(const Innovations& innovations) {
  std::vector<float> lit;
  lit.reserve(innovations.size());
  for (const auto& innovation : innovations)
    if (innovation) lit.push_back(*innovation);
  if (lit.size() * 4 < innovations.size()) return std::nullopt;
  return medianOf(lit);
}

bool isElsewhere(const ContentSeries& series, std::size_t tile, double innovation,
                 const ContentOptions& o) {
  return std::abs(innovation) >
         std::max(o.local_step, o.local_scales * kToSigma * series.deviation[tile]);
}

double rmsOf(const Innovations& innovations, double common) {
  double squares = 0;
  int lit = 0;
  for (const auto& innovation : innovations) {
    if (!innovation) continue;
    squares += (*innovation - common) * (*innovation - common);
    ++lit;
  }
  return lit > 0 ? std::sqrt(squares / lit) : 0;
}

void require(bool ok, const char* text) {
  if (!ok) throw CalibrationError(Exit::kUsage, std::string("light by content: ") + text);
}

}  // namespace

void ContentOptions::check() const {
  require(weight > 0 && weight <= 1, "weight, allowed (0, 1]");
  require(local_step > 0 && local_scales > 0, "local_step and local_scales, allowed above 0");
  require(moved_share > 0 && moved_share < 1, "moved_share, allowed (0, 1)");
  require(patience >= 1 && patience <= 100, "patience, allowed 1 to 100");
  require(gap_intervals > 1 && usual_times > 1, "gap_intervals and usual_times, allowed above 1");
  require(learn_samples >= 2, "learn_samples, allowed 2 or more");
  require(dark_level > 0 && dark_level < 1, "dark_level, allowed (0, 1)");
  require(common_noise > 0 && other_light > 0, "common_noise and other_light, allowed above 0");
}

TileLevels measureTiles(ImageView<const float> linear, RectPx patch) {
  return measure(linear.size(), patch, [&](RectPx t) {
    const int dx = std::max(1, t.width / kSamplesAcross),
              dy = std::max(1, t.height / kSamplesAcross);
    double sum = 0;
    std::int64_t n = 0;
    for (int y = t.y; y < t.y + t.height; y += dy)
      for (int x = t.x; x < t.x + t.width; x += dx)
        for (int c = 0; c < linear.channels; ++c, ++n) sum += linear.at(x, y, c);
    return n > 0 ? sum / static_cast<double>(n) : 0;
  });
}

TileLevels measureTiles(ImageView<const std::uint16_t> mosaic, double black_level,
                        double white_level, RectPx patch) {
  const double range = white_level - black_level;
  if (!(range > 0))
    throw CalibrationError(Exit::kBadData, "raw picture: white level does not lie above black");
  return measure(mosaic.size(), patch, [&](RectPx t) {
    const int dx = 2 * std::max(1, t.width / kSamplesAcross / 2),
              dy = 2 * std::max(1, t.height / kSamplesAcross / 2);
    double sum = 0;
    std::int64_t n = 0;
    for (int y = (t.y + 1) & ~1; y + 1 < t.y + t.height; y += dy)
      for (int x = (t.x + 1) & ~1; x + 1 < t.x + t.width; x += dx, n += 4)
        sum +=
            mosaic.at(x, y) + mosaic.at(x + 1, y) + mosaic.at(x, y + 1) + mosaic.at(x + 1, y + 1);
    return n > 0 ? (sum / static_cast<double>(n) - black_level) / range : 0;
  });
}

ContentJudgement judgeContent(const ContentSeries& series, const TileLevels& tiles, UtcTime utc,
                              const ContentOptions& o) {
  ContentJudgement j;
  if (!fits(series, tiles) || series.samples < o.learn_samples || isUnseen(series, utc, o))
    return j;
  const Innovations innovations = innovationsOf(series, tiles, o);
  const auto common = commonOf(innovations);
  if (!common) return j;
  j.known = true;
  j.common = std::expm1(*common - series.common_bias - series.common_trend);
  j.common_noise =
      std::max({o.common_noise, kToSigma * series.common_deviation, kOfTheTiles * series.usual_rms,
                kOfTheLast * std::abs(series.last_apart)});
  std::vector<float> moved;
  for (std::size_t i = 0; i < tiles.level.size(); ++i) {
    if (!innovations[i]) continue;
    const double innovation = *innovations[i] - *common;
    if (isElsewhere(series, i, innovation, o) && series.strays[i] < o.patience)
      moved.push_back(static_cast<float>(innovation));
  }
  j.moved_share = static_cast<double>(moved.size()) / static_cast<double>(tiles.level.size());
  j.moved = j.moved_share > std::max(o.moved_share, o.usual_times * series.usual_share);
  j.local = std::expm1(medianOf(moved).value_or(0));
  j.quiet = !j.moved &&
            rmsOf(innovations, *common) <= std::max(kLeastRms, o.usual_times * series.usual_rms);
  return j;
}

namespace {

void beginAnew(ContentSeries& series, const TileLevels& tiles) {
  series = {};
  series.columns = tiles.columns;
  series.rows = tiles.rows;
  for (const float level : tiles.level) series.forecast.push_back(logOf(level));
  series.deviation.assign(tiles.level.size(), kLeastDeviation);
  series.strays.assign(tiles.level.size(), 0);
  series.samples = 1;
}

// What it became while nobody looked is what it is now; how much it moves is remembered.
void lookAnew(ContentSeries& series, const TileLevels& tiles) {
  std::transform(tiles.level.begin(), tiles.level.end(), series.forecast.begin(), logOf);
  std::fill(series.strays.begin(), series.strays.end(), static_cast<unsigned char>(0));
}

// A visitor is not the specimen, unless it stays. Answers whether the tile is elsewhere.
bool takeTile(ContentSeries& series, std::size_t i, double innovation, double common, double share,
              const ContentOptions& o) {
  const bool elsewhere = isElsewhere(series, i, innovation - common, o);
  unsigned char& strays = series.strays[i];
  strays = static_cast<unsigned char>(elsewhere ? strays + 1 : 0);
  const auto away = static_cast<float>(std::abs(innovation - common));
  float& deviation = series.deviation[i];
  deviation += static_cast<float>(share) * (std::min(away, kMostSurprise * deviation) - deviation);
  deviation = std::max(deviation, kLeastDeviation);
  const bool stays = strays >= o.patience;
  const double change = stays ? innovation : o.weight * (elsewhere ? common : innovation);
  series.forecast[i] += static_cast<float>(change);
  if (stays) strays = 0;
  return elsewhere;
}

// What goes on as it began is ageing that quickens; a shock comes at once: it moves the pace by as
// much as one shot of ageing may, and is no trend.
void takePace(ContentSeries& series, double pace, double share) {
  const double foretold = series.common_bias + series.common_trend;
  const double most = std::max(kSudden, 4 * series.common_deviation);
  const bool goes_on = series.last_apart * (pace - foretold) > 0 &&
                       std::abs(pace - foretold) < kQuickening * std::abs(series.last_apart);
  const bool shock = !goes_on && std::abs(pace - foretold) > most;
  series.last_apart = pace - foretold;
  const double apart = shock ? std::clamp(pace - foretold, -most, most) : pace - foretold;
  series.common_bias = foretold + kPaceWeight * apart;
  series.common_trend = shock ? 0 : series.common_trend + kTrendWeight * kPaceWeight * apart;
  series.common_deviation += share * (std::abs(apart) - series.common_deviation);
}

}  // namespace

void takeIn(ContentSeries& series, const TileLevels& tiles, double patch, UtcTime utc,
            const ContentOptions& o) {
  const bool unseen = isUnseen(series, utc, o);
  const double gap_s = series.last_utc ? toSeconds(utc - *series.last_utc) : 0;
  if (!fits(series, tiles)) {
    beginAnew(series, tiles);
  } else if (unseen) {
    lookAnew(series, tiles);
  } else {
    const Innovations innovations = innovationsOf(series, tiles, o);
    const double common = commonOf(innovations).value_or(0);
    const double share = std::max(0.05, 1.0 / ++series.samples);
    takePace(series, common - std::log1p(patch), share);
    series.last_rms = rmsOf(innovations, common);
    series.usual_rms +=
        share *
        (std::min(series.last_rms, 3 * std::max(series.usual_rms, kLeastRms)) - series.usual_rms);
    int moved = 0;
    for (std::size_t i = 0; i < innovations.size(); ++i) {
      if (!innovations[i]) {
        series.forecast[i] = logOf(tiles.level[i]);
        continue;
      }
      moved += takeTile(series, i, *innovations[i], common, share, o) ? 1 : 0;
    }
    const double now = static_cast<double>(moved) / static_cast<double>(tiles.level.size());
    series.usual_share = std::max(kForgotten * series.usual_share,
                                  std::min(now, 1.5 * series.usual_share + o.moved_share / 5));
    if (gap_s > 0)
      series.usual_gap_s =
          series.usual_gap_s > 0 ? series.usual_gap_s + 0.1 * (gap_s - series.usual_gap_s) : gap_s;
  }
  series.last_utc = utc;
}

bool hasLightOf(const ContentSeries& other, const ContentSeries& own, const TileLevels& tiles,
                const ContentOptions& o) {
  if (!fits(other, tiles) || !fits(own, tiles)) return false;
  if (std::min(other.samples, own.samples) < o.learn_samples) return false;
  const auto usual = [&](const ContentSeries& s) {
    return std::max(kLeastRms, o.usual_times * s.usual_rms);
  };
  if (other.last_rms > usual(other) || own.last_rms > usual(own)) return false;
  const Innovations to_own = innovationsOf(own, tiles, o),
                    to_other = innovationsOf(other, tiles, o);
  const auto own_common = commonOf(to_own), other_common = commonOf(to_other);
  if (!own_common || !other_common) return false;
  const double from_own = rmsOf(to_own, *own_common);
  return from_own > std::max(o.other_light, 2 * usual(own)) &&
         3 * rmsOf(to_other, *other_common) < from_own;
}

}  // namespace patina::calibration
