// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/photon_transfer.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "calibration/sensor/rounded_noise.h"

namespace patina::calibration {
namespace {

constexpr double kHotSigmas = 8, kHotNumbersMin = 4;
constexpr double kFilledShare = 1e-3;  // of a colour's pixels at the top: the well is full
constexpr double kRangeMin = 0.1;      // of white, from the dimmest to the brightest tile
constexpr int kFitRounds = 5;

[[noreturn]] void refuse(const std::string& what) {
  throw CalibrationError(Exit::kBadData, "photon transfer: " + what);
}

// One tile of one colour in a pair.
struct Tile {
  double mean = 0, variance = 0, count = 0;
};

class Meter {
 public:
  explicit Meter(const PhotonTransferOptions& options) : options_(options) {}

  void addDarks(const RawPair& pair) {
    start(pair);
    if (hot_.empty()) findHot(pair);
    for (int c = 0; c < 3; ++c) {
      double n = 0, sum = 0, squares = 0, difference = 0, difference2 = 0;
      eachPixel(c, wholePicture(), [&](int x, int y) {
        const double a = pair.first.samples.at(x, y), b = pair.second.samples.at(x, y);
        const double mean = (a + b) / 2 - black_;
        n += 2;
        sum += 2 * mean;
        squares += (a - black_) * (a - black_) + (b - black_) * (b - black_);
        difference += a - b;
        difference2 += (a - b) * (a - b);
      });
      if (n < 4) refuse("the pictures have too few pixels of a colour");
      const double pairs = n / 2, offset = difference / pairs, mean = sum / n;
      Dark& dark = dark_[c];
      dark.level += mean;
      dark.half_difference += (difference2 / pairs - offset * offset) / 2;
      dark.variance += squares / n - mean * mean - offset * offset / 4;
    }
    ++report_.dark_pairs;
  }

  void endDarks() {
    if (report_.dark_pairs == 0)
      refuse("there is no pair of darks: shoot two with the lens closed, at the same ISO");
    for (Dark& dark : dark_) {
      dark.level /= report_.dark_pairs;
      dark.variance /= report_.dark_pairs;
      dark.half_difference /= report_.dark_pairs;
    }
  }

  void addFlats(const RawPair& pair) {
    start(pair);
    const int number = report_.flat_pairs++;
    for (int c = 0; c < 3; ++c) {
      std::int64_t at_top = 0, count = 0;
      std::vector<Tile> of_pair;
      bool cut = false;
      const int side = options_.tile_px;
      for (int y = 0; y < size_.height; y += side)
        for (int x = 0; x < size_.width; x += side) {
          const RectPx rect{x, y, std::min(side, size_.width - x),
                            std::min(side, size_.height - y)};
          std::int64_t top_here = 0;
          const Tile tile = tileOf(pair, c, rect, number, top_here, count);
          at_top += top_here;
          cut = cut || top_here > 0;
          if (top_here == 0 && tile.count >= 16) of_pair.push_back(tile);
        }
      if (static_cast<double>(at_top) > kFilledShare * static_cast<double>(count))
        report_.channels[c].well_filled = true;
      tiles_[c].insert(tiles_[c].end(), of_pair.begin(), of_pair.end());
      if (!cut && !of_pair.empty()) addLevel(c, of_pair, pair.first.exposure);
    }
  }

  PhotonTransfer finish() {
    if (report_.flat_pairs == 0) refuse("there is no pair of flats");
    for (int c = 0; c < 3; ++c) fit(c);
    return std::move(report_);
  }

 private:
  struct Dark {
    double level = 0, variance = 0, half_difference = 0;  // level above black
  };

  RectPx wholePicture() const { return {0, 0, size_.width, size_.height}; }

  void start(const RawPair& pair) {
    const RawMosaic& a = pair.first;
    if (size_.width == 0) {
      size_ = a.samples.size();
      cfa_ = a.cfa;
      black_ = a.black_level;
      white_ = a.white_level;
    }
    for (const RawMosaic* raw : {&pair.first, &pair.second})
      if (raw->samples.size() != size_ || raw->cfa != cfa_ || raw->black_level != black_ ||
          raw->white_level != white_)
        refuse("the pictures differ in size, colour filters, black or white level");
  }

  // Pixels of a colour within `rect`, but for the hot ones.
  template <class Body>
  void eachPixel(int c, RectPx rect, const Body& body) const {
    for (int y = rect.y; y < rect.y + rect.height; ++y)
      for (int x = rect.x; x < rect.x + rect.width; ++x) {
        if (cfa_[(y & 1) * 2 + (x & 1)] != c) continue;
        if (!hot_.empty() && hot_[static_cast<std::size_t>(y) * size_.width + x]) continue;
        body(x, y);
      }
  }

  void findHot(const RawPair& pair) {
    std::vector<bool> hot(static_cast<std::size_t>(size_.width) * size_.height);
    for (int c = 0; c < 3; ++c) {
      std::vector<float> means;
      const auto meanAt = [&](int x, int y) {
        return 0.5f *
               static_cast<float>(pair.first.samples.at(x, y) + pair.second.samples.at(x, y));
      };
      eachPixel(c, wholePicture(), [&](int x, int y) { means.push_back(meanAt(x, y)); });
      if (means.empty()) refuse("the pictures lack a colour");
      const auto middle = means.begin() + static_cast<std::ptrdiff_t>(means.size() / 2);
      std::nth_element(means.begin(), middle, means.end());
      const float median = *middle;
      for (float& mean : means) mean = std::abs(mean - median);
      std::nth_element(means.begin(), middle, means.end());
      const double limit = std::max(kHotNumbersMin, kHotSigmas * 1.4826 * *middle);
      eachPixel(c, wholePicture(), [&](int x, int y) {
        if (meanAt(x, y) - median <= limit) return;
        hot[static_cast<std::size_t>(y) * size_.width + x] = true;
        ++report_.hot_left_out;
      });
    }
    hot_ = std::move(hot);
  }

  Tile tileOf(const RawPair& pair, int c, RectPx rect, int number, std::int64_t& at_top,
              std::int64_t& count) const {
    double n = 0, sum_a = 0, sum_b = 0;
    const double dark = black_ + dark_[c].level;
    eachPixel(c, rect, [&](int x, int y) {
      const double a = pair.first.samples.at(x, y), b = pair.second.samples.at(x, y);
      at_top += a >= white_ || b >= white_;
      n += 1;
      sum_a += a - dark;
      sum_b += b - dark;
    });
    count += static_cast<std::int64_t>(n);
    if (n < 2 || at_top > 0 || !(sum_b > 0) || !(sum_a > 0)) return {};
    const double ratio = sum_a / sum_b, noise = std::sqrt(sum_a + sum_b);
    if (std::abs(ratio - 1) > options_.unequal_max && std::abs(sum_a - sum_b) > 10 * noise)
      refuse("the two of flat pair " + std::to_string(number + 1) +
             " differ in light by more than " +
             std::to_string(std::lround(100 * options_.unequal_max)) +
             " %: shoot both without touching lamp or exposure");
    double squares = 0;
    eachPixel(c, rect, [&](int x, int y) {
      const double d =
          pair.first.samples.at(x, y) - dark - ratio * (pair.second.samples.at(x, y) - dark);
      squares += d * d;
    });
    return {(sum_a + sum_b) / (2 * n), squares / ((n - 1) * (1 + ratio * ratio)), n};
  }

  void addLevel(int c, const std::vector<Tile>& tiles, std::optional<Nanoseconds> exposure) {
    TransferLevel level;
    double n = 0;
    for (const Tile& tile : tiles) {
      level.mean += tile.count * tile.mean;
      level.variance += tile.count * tile.variance;
      n += tile.count;
    }
    level.mean /= n;
    level.variance /= n;
    if (exposure) level.exposure_s = toSeconds(*exposure);
    report_.channels[c].levels.push_back(level);
  }

  // Of variance - dark variance over mean, a line through 0; weights by the fitted variance, as the
  // measured one would favour tiles that happen to be quiet.
  void fit(int c) {
    const Dark& dark = dark_[c];
    PhotonTransfer::Channel& out = report_.channels[c];
    double low = 1e300, high = 0;
    for (const Tile& tile : tiles_[c]) {
      low = std::min(low, tile.mean);
      high = std::max(high, tile.mean);
    }
    if (!(high - low >= kRangeMin * (white_ - black_)))
      refuse(
          "the levels of the flats span less than 10 % of white, or all are saturated: shoot "
          "pairs from nearly dark to nearly white");
    const double read =
        sigmaBehindRounding(black_ + dark.level, dark.variance, dark.half_difference);
    const double at_dark = read * read + kRoundingVariance;
    double slope = 1, weight_sum = 0;
    for (int round = 0; round < kFitRounds; ++round) {
      double up = 0, down = 0;
      for (const Tile& tile : tiles_[c]) {
        const double fitted = at_dark + slope * tile.mean;
        const double weight = tile.count / (2 * fitted * fitted);
        up += weight * tile.mean * (tile.variance - at_dark);
        down += weight * tile.mean * tile.mean;
      }
      slope = std::max(1e-9, up / down);
      weight_sum = down;
    }
    out.gain_error = 1 / (std::sqrt(weight_sum) * slope);
    NoiseModel& noise = report_.noise[c];
    noise.electrons_per_number = 1 / slope;
    noise.read_noise_e = read / slope;
    noise.black_level = black_;
    noise.white_level = white_;
    noise.full_well_e = (out.well_filled ? white_ - black_ : high + dark.level) / slope;
    double squares = 0;
    for (const TransferLevel& level : out.levels) {
      const double off = level.variance / (at_dark + slope * level.mean) - 1;
      squares += off * off;
    }
    if (!out.levels.empty())
      out.residual = std::sqrt(squares / static_cast<double>(out.levels.size()));
    out.nonlinearity = nonlinearityOf(out.levels);
  }

  // EMVA 1288, 6.6: relative departures from a line, here through the dark, over 5 % to 95 %.
  std::optional<double> nonlinearityOf(const std::vector<TransferLevel>& levels) const {
    double count = 0, slope = 0, least = 1e300, most = 0;
    const auto counts = [&](const TransferLevel& level) {
      return level.exposure_s && *level.exposure_s > 0 && level.mean >= 0.05 * (white_ - black_) &&
             level.mean <= 0.95 * (white_ - black_);
    };
    for (const TransferLevel& level : levels) {
      if (!counts(level)) continue;
      slope += level.mean / *level.exposure_s;
      least = std::min(least, *level.exposure_s);
      most = std::max(most, *level.exposure_s);
      count += 1;
    }
    if (count < 3 || most < 1.5 * least) return std::nullopt;
    double worst = 0;
    for (const TransferLevel& level : levels)
      if (counts(level))
        worst = std::max(worst, std::abs(level.mean / *level.exposure_s / (slope / count) - 1));
    return worst;
  }

  const PhotonTransferOptions& options_;
  PhotonTransfer report_;
  SizePx size_{0, 0};
  std::array<std::uint8_t, 4> cfa_{};
  double black_ = 0, white_ = 0;
  std::vector<bool> hot_;
  std::array<Dark, 3> dark_{};
  std::array<std::vector<Tile>, 3> tiles_;
};

}  // namespace

void PhotonTransferOptions::check() const {
  if (tile_px < 8 || tile_px > 1024 || tile_px % 2 != 0)
    throw CalibrationError(
        Exit::kUsage, "tile_px must be even and from 8 to 1024, not " + std::to_string(tile_px));
  if (!(unequal_max > 0 && unequal_max <= 0.5))
    throw CalibrationError(Exit::kUsage, "unequal_max must lie in (0, 0.5]");
}

PhotonTransfer measurePhotonTransfer(const PairSource& darks, const PairSource& flats,
                                     const PhotonTransferOptions& options, Progress& progress) {
  options.check();
  Meter meter(options);
  progress.begin("pairs of darks", 0);
  while (const std::optional<RawPair> pair = darks()) {
    meter.addDarks(*pair);
    progress.step();
  }
  meter.endDarks();
  progress.begin("pairs of flats", 0);
  while (const std::optional<RawPair> pair = flats()) {
    meter.addFlats(*pair);
    progress.step();
  }
  return meter.finish();
}

}  // namespace patina::calibration
