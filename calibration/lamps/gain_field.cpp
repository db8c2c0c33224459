// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/gain_field.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "calibration/lamps/median.h"
#include "calibration/lamps/normal_equations.h"
#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr int kBlocksASide = 128;
constexpr double kLeftOutMost = 0.2;  // of the blocks
constexpr int kDegreeMost = 8, kTermsMost = (kDegreeMost + 1) * (kDegreeMost + 2) / 2;

int termsOf(int degree) { return (degree + 1) * (degree + 2) / 2; }

// P_0 ... P_degree at u of [-1, 1].
void legendre(double u, int degree, double* p) {
  p[0] = 1;
  if (degree > 0) p[1] = u;
  for (int n = 2; n <= degree; ++n) p[n] = ((2 * n - 1) * u * p[n - 1] - (n - 1) * p[n - 2]) / n;
}

void terms(double u, double v, int degree, double* out) {
  double x[kDegreeMost + 1], y[kDegreeMost + 1];
  legendre(u, degree, x);
  legendre(v, degree, y);
  for (int j = 0; j <= degree; ++j)
    for (int i = 0; i + j <= degree; ++i) *out++ = x[i] * y[j];
}

struct Block {
  double u = 0, v = 0;  // of its texels' mean, [-1, 1]
  std::array<double, 3> level{};
  bool used = true;
};

bool isIn(std::span<const RectPx> regions, int x, int y) {
  if (regions.empty()) return true;
  return std::any_of(regions.begin(), regions.end(), [&](const RectPx& r) {
    return x >= r.x && y >= r.y && x < r.x + r.width && y < r.y + r.height;
  });
}

// Means over blocks of the target; blocks with a texel beside it are not of it.
std::vector<Block> blocksOf(ImageView<const float> target, std::span<const RectPx> regions) {
  const int side =
      std::max(1, (std::max(target.width, target.height) + kBlocksASide - 1) / kBlocksASide);
  const int columns = target.width / side, rows = target.height / side;
  std::vector<Block> blocks(static_cast<std::size_t>(columns) * rows);
  forEachRow(rows, std::int64_t{target.width} * side * target.channels, [&](int row) {
    for (int column = 0; column < columns; ++column) {
      Block& block = blocks[static_cast<std::size_t>(row) * columns + column];
      const int x0 = column * side, y0 = row * side;
      block.used = isIn(regions, x0, y0) && isIn(regions, x0 + side - 1, y0 + side - 1) &&
                   isIn(regions, x0, y0 + side - 1) && isIn(regions, x0 + side - 1, y0);
      if (!block.used) continue;
      block.u = 2 * (x0 + side / 2.0) / target.width - 1;
      block.v = 2 * (y0 + side / 2.0) / target.height - 1;
      for (int y = y0; y < y0 + side; ++y)
        for (int x = x0; x < x0 + side; ++x)
          for (int c = 0; c < target.channels; ++c)
            block.level[c] += target.at(x, y, c) / (static_cast<double>(side) * side);
    }
  });
  std::erase_if(blocks, [](const Block& block) { return !block.used; });
  return blocks;
}

std::vector<double> solved(const std::vector<Block>& blocks, int channel, int degree) {
  NormalEquations equations(termsOf(degree));
  double row[kTermsMost];
  for (const Block& block : blocks) {
    if (!block.used) continue;
    terms(block.u, block.v, degree, row);
    equations.add({row, static_cast<std::size_t>(termsOf(degree))}, block.level[channel]);
  }
  return equations.solved();
}

double valueAt(const std::vector<double>& k, const Block& block, int degree) {
  double row[kTermsMost];
  terms(block.u, block.v, degree, row);
  double sum = 0;
  for (std::size_t i = 0; i < k.size(); ++i) sum += k[i] * row[i];
  return sum;
}

void checkTarget(const std::vector<Block>& blocks, int channels, const FieldOptions& options,
                 FieldReport& report) {
  if (static_cast<int>(blocks.size()) < 4 * termsOf(options.degree))
    throw CalibrationError(Exit::kBadData, "the target is too small in the picture for a field");
  double u0 = 1, u1 = -1, v0 = 1, v1 = -1;
  for (const Block& b : blocks) {
    u0 = std::min(u0, b.u);
    u1 = std::max(u1, b.u);
    v0 = std::min(v0, b.v);
    v1 = std::max(v1, b.v);
  }
  report.cover_width = (u1 - u0) / 2;
  report.cover_height = (v1 - v0) / 2;
  if (std::min(report.cover_width, report.cover_height) < options.cover_least)
    throw CalibrationError(Exit::kBadData,
                           "the target spans too little of the picture: beyond it the field would "
                           "be a guess; use a larger one or place it at several spots");
  for (int c = 0; c < channels; ++c) {
    std::vector<double> levels;
    for (const Block& b : blocks) levels.push_back(b.level[c]);
    const double highest = *std::max_element(levels.begin(), levels.end());
    if (!(medianOf(levels) >= options.level_least))
      throw CalibrationError(Exit::kBadData, "the target is too dark for a field; expose longer");
    if (highest > options.level_most)
      throw CalibrationError(Exit::kBadData, "the target is clipped; expose shorter");
  }
}

// Leaves out what lies beyond clip_sigma of any channel; returns the relative RMS of the rest.
double clip(std::vector<Block>& blocks, const std::vector<std::vector<double>>& k,
            const FieldOptions& options) {
  std::vector<double> off(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i)
    for (std::size_t c = 0; c < k.size(); ++c) {
      const double model = valueAt(k[c], blocks[i], options.degree);
      off[i] = std::max(off[i], std::abs(blocks[i].level[c] / std::max(model, 1e-9) - 1));
    }
  const double limit = options.clip_sigma * std::max(1.4826 * medianOf(off), 1e-9);
  double square = 0;
  int used = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    blocks[i].used = off[i] <= limit;
    if (!blocks[i].used) continue;
    square += off[i] * off[i];
    ++used;
  }
  return std::sqrt(square / std::max(used, 1));
}

}  // namespace

void FieldOptions::check() const {
  const auto share = [](const char* field, double value) {
    if (!(value > 0 && value <= 1))
      throw CalibrationError(Exit::kUsage, std::string(field) + " is " + std::to_string(value) +
                                               "; it lies between 0 and 1");
  };
  if (degree < 0 || degree > kDegreeMost)
    throw CalibrationError(Exit::kUsage, "degree is " + std::to_string(degree) + "; it is 0 to 8");
  if (!(clip_sigma > 1)) throw CalibrationError(Exit::kUsage, "clip_sigma is above 1");
  share("level_least", level_least);
  share("level_most", level_most);
  share("cover_least", cover_least);
  share("residual_most", residual_most);
}

LampField fitLampField(ImageView<const float> target, std::span<const RectPx> regions,
                       const FieldOptions& options, Progress& progress) {
  options.check();
  if (target.empty() || target.channels > 3)
    throw CalibrationError(Exit::kBadData, "a target's picture has 1 to 3 channels");
  progress.begin("field", 2);
  std::vector<Block> blocks = blocksOf(target, regions);
  progress.step();
  LampField field{target.size(), target.channels, options.degree, {}, {}};
  checkTarget(blocks, target.channels, options, field.report);
  std::vector<std::vector<double>> k(static_cast<std::size_t>(target.channels));
  for (int round = 0; round < 4; ++round) {
    for (int c = 0; c < target.channels; ++c) k[c] = solved(blocks, c, options.degree);
    field.report.residual_rms = clip(blocks, k, options);
  }
  field.report.blocks = static_cast<int>(blocks.size());
  for (const Block& b : blocks) field.report.left_out += !b.used;
  if (!(field.report.residual_rms <= options.residual_most) ||
      field.report.left_out > kLeftOutMost * field.report.blocks)
    throw CalibrationError(
        Exit::kBadData,
        "what shows there is no even target: " + std::to_string(100 * field.report.residual_rms) +
            " % RMS off a smooth field; say where it lies: --target x,y,w,h");
  field.report.lowest = 1e30;
  for (int c = 0; c < target.channels; ++c) {
    const double mean = k[c][0];
    field.report.mean[c] = mean;
    for (const double value : k[c]) field.coefficients.push_back(value);
    for (const double u : {-1.0, 0.0, 1.0})
      for (const double v : {-1.0, 0.0, 1.0}) {
        const double share = valueAt(k[c], {u, v, {}, true}, options.degree) / mean;
        field.report.lowest = std::min(field.report.lowest, share);
        field.report.highest = std::max(field.report.highest, share);
      }
  }
  progress.step();
  return field;
}

Image<float> paintField(const LampField& field) {
  const int n = termsOf(field.degree);
  PATINA_CHECK(field.coefficients.size() == static_cast<std::size_t>(n) * field.channels);
  Image<float> painted(field.size.width, field.size.height, field.channels);
  forEachRow(field.size.height, std::int64_t{field.size.width} * n, [&](int y) {
    double across[kDegreeMost + 1], x_terms[kDegreeMost + 1];
    legendre(2 * (y + 0.5) / field.size.height - 1, field.degree, across);
    for (int c = 0; c < field.channels; ++c) {
      // The row is a polynomial in x alone.
      const double* k = &field.coefficients[static_cast<std::size_t>(c) * n];
      const double floor = 1e-3 * k[0];
      double along[kDegreeMost + 1] = {};
      for (int j = 0; j <= field.degree; ++j)
        for (int i = 0; i + j <= field.degree; ++i) along[i] += *k++ * across[j];
      for (int x = 0; x < field.size.width; ++x) {
        legendre(2 * (x + 0.5) / field.size.width - 1, field.degree, x_terms);
        double sum = 0;
        for (int i = 0; i <= field.degree; ++i) sum += along[i] * x_terms[i];
        painted.at(x, y, c) = static_cast<float>(std::max(sum, floor));
      }
    }
  });
  return painted;
}

}  // namespace patina::calibration
