// SPDX-License-Identifier: GPL-3.0-or-later
// Where the fit begins: photometric stereo (Woodham 1980) on levels of the middle, per texel.
#include <algorithm>
#include <cmath>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf::lanes {
namespace {

constexpr double kLowShare = 0.25, kHighShare = 0.8;  // quantiles between which levels count
constexpr int kRounds = 4;
constexpr double kFlattest = 0.15;     // n.z of a start is not below
constexpr float kShadowShare = 0.35f;  // of what Lambert predicts: below is cast shadow
constexpr float kShadowSigma = 5;

struct Level {
  double x, y, z, level;  // light and level over irradiance
  double weight;
};

// b of level = b . l by weighted least squares; false when the lights do not span space.
bool solveNormal(const std::vector<Level>& levels, double (&b)[3]) {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, rx = 0, ry = 0, rz = 0;
  for (const Level& l : levels) {
    const double wx = l.weight * l.x, wy = l.weight * l.y, wz = l.weight * l.z;
    xx += wx * l.x, xy += wx * l.y, xz += wx * l.z;
    yy += wy * l.y, yz += wy * l.z, zz += wz * l.z;
    rx += wx * l.level, ry += wy * l.level, rz += wz * l.level;
  }
  const double cx = yy * zz - yz * yz, cy = xz * yz - xy * zz, cz = xy * yz - yy * xz;
  const double det = xx * cx + xy * cy + xz * cz, trace = xx + yy + zz;
  if (!(det > 1e-6 * trace * trace * trace / 27)) return false;
  b[0] = (rx * cx + ry * cy + rz * cz) / det;
  b[1] = (rx * cy + ry * (xx * zz - xz * xz) + rz * (xz * xy - xx * yz)) / det;
  b[2] = (rx * cz + ry * (xy * xz - xx * yz) + rz * (xx * yy - xy * xy)) / det;
  return true;
}

void middleOnly(std::vector<Level>& levels, std::vector<double>& sorted) {
  sorted.clear();
  for (const Level& l : levels) sorted.push_back(l.level);
  std::sort(sorted.begin(), sorted.end());
  const auto last = static_cast<double>(sorted.size() - 1);
  const double low = sorted[static_cast<std::size_t>(last * kLowShare)];
  const double high = sorted[static_cast<std::size_t>(std::ceil(last * kHighShare))];
  for (Level& l : levels) l.weight = l.level >= low && l.level <= high ? 1 : 0;
}

double medianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Highlights lie above, shadows below what a matt surface gives: both lose weight.
void reweighMatt(std::vector<Level>& levels, const double (&b)[3], std::vector<double>& off) {
  off.clear();
  for (const Level& l : levels)
    off.push_back(std::abs(l.level - std::max(b[0] * l.x + b[1] * l.y + b[2] * l.z, 0.0)));
  std::vector<double> sorted = off;
  const double scale = std::max(2 * medianOf(sorted), 1e-6);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const Level& l = levels[i];
    const bool lit = b[0] * l.x + b[1] * l.y + b[2] * l.z > 0;
    levels[i].weight = lit ? 1 / (1 + off[i] * off[i] / (scale * scale)) : 0;
  }
}

struct Start {
  double nx = 0, ny = 0, nz = 1, kd = 0;
};
Start startOf(std::vector<Level>& levels, std::vector<double>& scratch) {
  double b[3] = {0, 0, 0};
  middleOnly(levels, scratch);
  bool known = solveNormal(levels, b);
  if (!known) {  // the middle lies in one plane: all of them
    for (Level& l : levels) l.weight = 1;
    known = solveNormal(levels, b);
  }
  for (int round = 0; known && round < kRounds; ++round) {
    reweighMatt(levels, b, scratch);
    double next[3];
    if (!solveNormal(levels, next)) break;
    std::copy_n(next, 3, b);
  }
  const double length = std::sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
  if (!known || !(length > 0)) return {};
  Start start{b[0] / length, b[1] / length, b[2] / length, length};
  if (start.nz >= kFlattest) return start;
  const double across = std::hypot(start.nx, start.ny), to = std::sqrt(1 - kFlattest * kFlattest);
  start.nx *= to / std::max(across, 1e-9);
  start.ny *= to / std::max(across, 1e-9);
  start.nz = across > 1e-9 ? kFlattest : 1;
  return start;
}

}  // namespace

void photometricStart(Samples& samples, Estimate& at) {
  std::vector<Level> levels;
  std::vector<double> scratch;
  for (int k = 0; k < kLanes; ++k) {
    levels.clear();
    for (std::size_t i = 0; i < samples.count; ++i) {
      samples.light[i].weight[k] = 0;
      if (samples.light[i].noise[k] > 0)
        levels.push_back({samples.light[i].lx[k], samples.light[i].ly[k], samples.light[i].lz[k],
                          samples.light[i].y[k] / samples.light[i].e[k], 1});
    }
    const Start start = levels.size() < 3 ? Start{} : startOf(levels, scratch);
    at.nx[k] = static_cast<float>(start.nx);
    at.ny[k] = static_cast<float>(start.ny);
    at.nz[k] = static_cast<float>(start.nz);
    at.kd[k] = static_cast<float>(start.kd);
    at.ks[k] = 0;
    at.u[k] = std::log(0.3f);
    for (std::size_t i = 0; i < samples.count; ++i) {
      const float n_l = at.nx[k] * samples.light[i].lx[k] + at.ny[k] * samples.light[i].ly[k] +
                        at.nz[k] * samples.light[i].lz[k];
      const float matt = at.kd[k] * samples.light[i].e[k] * n_l, noise = samples.light[i].noise[k];
      const float below = (matt - samples.light[i].y[k]) * std::sqrt(noise);
      const bool shadow =
          n_l <= 0 || (samples.light[i].y[k] < kShadowShare * matt && below > kShadowSigma);
      samples.light[i].weight[k] = shadow ? 0 : noise;
    }
  }
}

}  // namespace patina::brdf::lanes
