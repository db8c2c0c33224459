// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/light_file_check.h"

#include <algorithm>
#include <cmath>

#include "calibration/lamps/median.h"
#include "calibration/lamps/vec3.h"
#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

using Pictures = std::span<const ImageView<const float>>;

constexpr int kRounds = 4;           // of reweighting, against shadows and gloss
constexpr double kTexelsApart = 6;   // that count as independent witnesses of curl
constexpr double kSlopeLeast = 0.4;  // a correlation below this is no mirroring, however sure
constexpr double kUnusual = 1.5;     // times the median misfit

std::vector<Vec3> unitLights(std::span<const std::array<double, 3>> directions) {
  std::vector<Vec3> lights;
  for (const auto& [x, y, z] : directions) {
    const Vec3 light{x, y, z};
    if (!(norm(light) > 0) || !std::isfinite(norm(light)))
      throw CalibrationError(Exit::kBadData, "a light has no direction");
    lights.push_back(unit(light));
  }
  return lights;
}

// Albedo times normal of every texel; weights fall with the residual, so that shadows and
// highlights count little.
std::vector<Vec3> scaledNormals(Pictures pictures, const std::vector<Vec3>& lights) {
  const int width = pictures[0].width, height = pictures[0].height;
  std::vector<Vec3> normals(static_cast<std::size_t>(width) * height);
  const auto count = lights.size();
  forEachRow(height, std::int64_t{width} * static_cast<int>(count) * 40, [&](int y) {
    std::vector<double> level(count), weight(count), off(count), sorted(count);
    for (int x = 0; x < width; ++x) {
      for (std::size_t i = 0; i < count; ++i) level[i] = pictures[i].at(x, y);
      std::fill(weight.begin(), weight.end(), 1.0);
      Vec3 normal{};
      for (int round = 0; round < kRounds; ++round) {
        // Columns of the symmetric matrix of the normal equations.
        Vec3 a{1e-9, 0, 0}, b{0, 1e-9, 0}, c{0, 0, 1e-9}, right{};
        for (std::size_t i = 0; i < count; ++i) {
          const Vec3& l = lights[i];
          a = sum(a, l, weight[i] * l[0]);
          b = sum(b, l, weight[i] * l[1]);
          c = sum(c, l, weight[i] * l[2]);
          right = sum(right, l, weight[i] * level[i]);
        }
        const double volume = dot(a, cross(b, c));
        normal = {dot(right, cross(b, c)) / volume, dot(a, cross(right, c)) / volume,
                  dot(a, cross(b, right)) / volume};
        for (std::size_t i = 0; i < count; ++i)
          off[i] = std::abs(level[i] - std::max(dot(normal, lights[i]), 0.0));
        sorted = off;
        const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count / 2);
        std::nth_element(sorted.begin(), middle, sorted.end());
        const double scale = std::max(2 * *middle, 1e-9);
        for (std::size_t i = 0; i < count; ++i)
          weight[i] = 1 / (1 + (off[i] / scale) * (off[i] / scale));
      }
      normals[static_cast<std::size_t>(y) * width + x] = normal;
    }
  });
  return normals;
}

double medianOfSizes(std::vector<double> values) {
  for (double& v : values) v = std::abs(v);
  return medianOf(std::move(values));
}

struct Correlation {
  double value = 0, sigma = 0;
};

// Of dp/dy and dq/dx, each limited to four times its median, so that edges do not decide.
Correlation parityOf(const std::vector<Vec3>& normals, int width, int height) {
  const auto slopeAt = [&](int x, int y) -> std::array<double, 2> {
    const Vec3& b = normals[static_cast<std::size_t>(y) * width + x];
    if (!(b[2] > 0.2 * norm(b))) return {0, 0};
    return {-b[0] / b[2], -b[1] / b[2]};
  };
  std::vector<double> p_y, q_x;
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) {
      p_y.push_back(slopeAt(x, y - 1)[0] - slopeAt(x, y + 1)[0]);  // rows go down, y up
      q_x.push_back(slopeAt(x + 1, y)[1] - slopeAt(x - 1, y)[1]);
    }
  if (p_y.empty()) return {};
  const double most_p = 4 * medianOfSizes(p_y), most_q = 4 * medianOfSizes(q_x);
  double pq = 0, pp = 0, qq = 0;
  for (std::size_t i = 0; i < p_y.size(); ++i) {
    const double p = std::clamp(p_y[i], -most_p, most_p), q = std::clamp(q_x[i], -most_q, most_q);
    pq += p * q;
    pp += p * p;
    qq += q * q;
  }
  if (!(pp > 0 && qq > 0)) return {};
  const double value = pq / std::sqrt(pp * qq);
  return {value, value * std::sqrt(static_cast<double>(p_y.size()) / kTexelsApart)};
}

// Slopes of ln(picture / mean picture) across the picture, right and up, per picture.
std::vector<std::array<double, 2>> slopesOf(Pictures pictures) {
  const int width = pictures[0].width, height = pictures[0].height;
  std::vector<double> mean(static_cast<std::size_t>(width) * height);
  for (const auto& picture : pictures)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        mean[static_cast<std::size_t>(y) * width + x] +=
            std::max(picture.at(x, y), 0.0f) / static_cast<double>(pictures.size());
  double level = 0;
  for (const double v : mean) level += v / static_cast<double>(mean.size());
  std::vector<std::array<double, 2>> slopes;
  for (const auto& picture : pictures) {
    // Means over thirds left, right, top and bottom of the limited ratio: no outlier decides.
    double sum[4] = {}, count[4] = {};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double base = mean[static_cast<std::size_t>(y) * width + x];
        if (!(base > 0.05 * level)) continue;
        const double ratio = std::clamp(picture.at(x, y) / base, 0.0, 3.0);
        const bool in[4] = {3 * x < width, 3 * x >= 2 * width, 3 * y < height, 3 * y >= 2 * height};
        for (int side = 0; side < 4; ++side)
          if (in[side]) {
            sum[side] += ratio;
            ++count[side];
          }
      }
    const auto of = [&](int side) { return sum[side] / std::max(count[side], 1.0); };
    const auto contrast = [](double a, double b) { return (a - b) / std::max(a + b, 1e-9); };
    slopes.push_back({contrast(of(1), of(0)), contrast(of(2), of(3))});
  }
  return slopes;
}

Correlation along(int axis, const std::vector<std::array<double, 2>>& slopes,
                  const std::vector<Vec3>& lights) {
  const auto n = static_cast<double>(lights.size());
  double mean_s = 0, mean_l = 0, sl = 0, ss = 0, ll = 0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    mean_s += slopes[i][axis] / n;
    mean_l += lights[i][axis] / n;
  }
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const double s = slopes[i][axis] - mean_s, l = lights[i][axis] - mean_l;
    sl += s * l;
    ss += s * s;
    ll += l * l;
  }
  if (!(ss > 0 && ll > 0)) return {};
  const double r = std::clamp(sl / std::sqrt(ss * ll), -0.999999, 0.999999);
  return {r, std::atanh(r) * std::sqrt(std::max(n - 3, 1.0))};  // Fisher's transform
}

// sqrt(1 - cos^2) of each picture against the shading by each light, [picture][light]. Albedo drops
// out: everything is taken over the texel's own.
using Misfits = std::vector<std::vector<double>>;
Misfits misfits(Pictures pictures, const std::vector<Vec3>& normals,
                const std::vector<Vec3>& lights, Progress& progress) {
  const std::size_t count = lights.size();
  const int width = pictures[0].width, height = pictures[0].height;
  Misfits out(count, std::vector<double>(count));
  std::vector<double> seen2(count), shade2(count), seen(count), shade(count);
  for (int y = 0; y < height; y += 2) {
    for (int x = 0; x < width; x += 2) {
      const Vec3& normal = normals[static_cast<std::size_t>(y) * width + x];
      const double albedo = norm(normal);
      if (!(albedo > 0)) continue;
      for (std::size_t i = 0; i < count; ++i) {
        shade[i] = std::max(dot(normal, lights[i]) / albedo, 0.0);
        seen[i] = std::clamp(pictures[i].at(x, y) / albedo, 0.0, 1.5);
        shade2[i] += shade[i] * shade[i];
        seen2[i] += seen[i] * seen[i];
      }
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < count; ++j) out[i][j] += seen[i] * shade[j];
    }
    progress.step(std::min(2, height - y));
  }
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j) {
      const double cosine2 = out[i][j] * out[i][j] / std::max(seen2[i] * shade2[j], 1e-300);
      out[i][j] = std::sqrt(std::max(1 - cosine2, 0.0));
    }
  return out;
}

// Pairs whose pictures are much better explained by each other's light, the clearest first; each
// picture in one pair at most. Pictures that fit as well as most do are left alone.
std::vector<std::pair<int, int>> exchangedBy(const Misfits& misfit, double better_least) {
  struct Exchange {
    double ratio;
    std::size_t i, j;
  };
  std::vector<double> own;
  for (std::size_t i = 0; i < misfit.size(); ++i) own.push_back(misfit[i][i]);
  const double usual = medianOf(own);
  std::vector<Exchange> exchanges;
  for (std::size_t i = 0; i < misfit.size(); ++i)
    for (std::size_t j = i + 1; j < misfit.size(); ++j) {
      const double before = own[i] + own[j], after = misfit[i][j] + misfit[j][i];
      if (std::min(own[i], own[j]) > kUnusual * usual && after < better_least * before)
        exchanges.push_back({after / before, i, j});
    }
  std::sort(exchanges.begin(), exchanges.end(),
            [](const Exchange& a, const Exchange& b) { return a.ratio < b.ratio; });
  std::vector<bool> taken(misfit.size());
  std::vector<std::pair<int, int>> pairs;
  for (const Exchange& exchange : exchanges) {
    if (taken[exchange.i] || taken[exchange.j]) continue;
    taken[exchange.i] = taken[exchange.j] = true;
    pairs.emplace_back(static_cast<int>(exchange.i), static_cast<int>(exchange.j));
  }
  return pairs;
}

Mirroring mirroringOf(const LightFileCheck& c, double sure) {
  const auto sign = [&](double value, double sigma, double least) {
    return std::abs(sigma) >= sure && std::abs(value) >= least ? (value > 0 ? 1 : -1) : 0;
  };
  const int x = sign(c.slope_x, c.slope_x_sigma, kSlopeLeast),
            y = sign(c.slope_y, c.slope_y_sigma, kSlopeLeast),
            parity = sign(c.parity, c.parity_sigma, 0.05);
  if (x != 0 && y != 0) {
    if (parity != 0 && parity != x * y) return Mirroring::kUnclear;
    if (x > 0) return y > 0 ? Mirroring::kNone : Mirroring::kY;
    return y > 0 ? Mirroring::kX : Mirroring::kXY;
  }
  if (parity == 0) return Mirroring::kUnclear;
  if (x == 0 && y == 0) return parity > 0 ? Mirroring::kNone : Mirroring::kOneOfXY;
  const int other = parity * (x + y);  // of the axis that no slope told
  const int of_x = x != 0 ? x : other, of_y = y != 0 ? y : other;
  if (of_x > 0) return of_y > 0 ? Mirroring::kNone : Mirroring::kY;
  return of_y > 0 ? Mirroring::kX : Mirroring::kXY;
}

}  // namespace

void LightFileOptions::check() const {
  if (!(sure_sigma > 0)) throw CalibrationError(Exit::kUsage, "sure_sigma is above 0");
  if (!(better_least > 0 && better_least < 1))
    throw CalibrationError(Exit::kUsage, "better_least lies between 0 and 1");
}

bool LightFileCheck::fits() const {
  return behind == 0 && exchanged.empty() &&
         (mirroring == Mirroring::kNone || mirroring == Mirroring::kUnclear);
}

LightFileCheck checkLightFile(Pictures pictures, std::span<const std::array<double, 3>> directions,
                              const LightFileOptions& options, Progress& progress) {
  options.check();
  if (pictures.size() != directions.size())
    throw CalibrationError(Exit::kBadData, "the light file has " +
                                               std::to_string(directions.size()) + " lights for " +
                                               std::to_string(pictures.size()) + " pictures");
  if (pictures.size() < 4)
    throw CalibrationError(Exit::kBadData, "fewer than 4 lights cannot be checked by shading");
  for (const auto& picture : pictures)
    if (picture.size() != pictures[0].size() || picture.channels != 1)
      throw CalibrationError(Exit::kBadData, "the pictures differ in size");
  const std::vector<Vec3> lights = unitLights(directions);
  const int width = pictures[0].width, height = pictures[0].height;
  progress.begin("light file", height);
  LightFileCheck check;
  for (const Vec3& light : lights) check.behind += light[2] <= 0;
  const std::vector<Vec3> normals = scaledNormals(pictures, lights);
  const Correlation parity = parityOf(normals, width, height);
  const auto slopes = slopesOf(pictures);
  const Correlation x = along(0, slopes, lights), y = along(1, slopes, lights);
  check.parity = parity.value;
  check.parity_sigma = parity.sigma;
  check.slope_x = x.value;
  check.slope_x_sigma = x.sigma;
  check.slope_y = y.value;
  check.slope_y_sigma = y.sigma;
  check.mirroring = mirroringOf(check, options.sure_sigma);
  const Misfits misfit = misfits(pictures, normals, lights, progress);
  for (std::size_t i = 0; i < misfit.size(); ++i) check.misfit.push_back(misfit[i][i]);
  check.exchanged = exchangedBy(misfit, options.better_least);
  return check;
}

std::string sentence(const LightFileCheck& check) {
  std::string text;
  const auto say = [&](const std::string& what) { text += (text.empty() ? "" : "; ") + what; };
  if (check.behind > 0)
    say(std::to_string(check.behind) +
        " lights shine from behind (z <= 0): z points to the camera");
  switch (check.mirroring) {
    case Mirroring::kX:
      say("x is mirrored: turn the sign of every x");
      break;
    case Mirroring::kY:
      say("y is mirrored: y points up; turn the sign of every y");
      break;
    case Mirroring::kXY:
      say("x and y are mirrored (turned by 180 degrees): turn the signs of both");
      break;
    case Mirroring::kOneOfXY:
      say("either x or y is mirrored (left-handed): turn the sign of one");
      break;
    case Mirroring::kUnclear:
      say("the pictures cannot say whether the lights are mirrored");
      break;
    case Mirroring::kNone:
      break;
  }
  for (const auto& [i, j] : check.exchanged)
    say("pictures " + std::to_string(i + 1) + " and " + std::to_string(j + 1) +
        " seem to have each other's light");
  return text.empty() ? "the lights fit the pictures" : text;
}

}  // namespace patina::calibration
