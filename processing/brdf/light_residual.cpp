// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/light_residual.h"

#include <cmath>

#include "processing/image/parallel_rows.h"

namespace patina::brdf {
namespace {

constexpr double kWidths[] = {0.12, 0.18, 0.25, 0.35, 0.5};
constexpr double kRidges[] = {0.01, 0.03, 0.1, 0.3, 1.0};
constexpr std::size_t kTried = 1500;  // texels that width and ridge are chosen on

class Square {
 public:
  explicit Square(std::size_t n) : n_(n), values_(n * n) {}
  std::size_t size() const { return n_; }
  double& at(std::size_t i, std::size_t j) { return values_[i * n_ + j]; }
  double at(std::size_t i, std::size_t j) const { return values_[i * n_ + j]; }

 private:
  std::size_t n_;
  std::vector<double> values_;
};

double kernel(const Vec3& a, const Vec3& b, double width) {
  const double x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return std::exp(-(x * x + y * y + z * z) / (2 * width * width));
}

// Gauss and Jordan in place; positive definite, so the diagonal serves as pivot.
void invert(Square& m) {
  const std::size_t n = m.size();
  for (std::size_t p = 0; p < n; ++p) {
    const double pivot = 1 / m.at(p, p);
    m.at(p, p) = 1;
    for (std::size_t j = 0; j < n; ++j) m.at(p, j) *= pivot;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == p) continue;
      const double factor = m.at(i, p);
      m.at(i, p) = 0;
      for (std::size_t j = 0; j < n; ++j) m.at(i, j) -= factor * m.at(p, j);
    }
  }
}

Square smoother(const std::vector<Vec3>& lights, double width, double ridge) {
  Square m(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i)
    for (std::size_t j = 0; j < lights.size(); ++j)
      m.at(i, j) = kernel(lights[i], lights[j], width) + (i == j ? ridge : 0);
  invert(m);
  return m;
}

// A sample's error when its own picture is left out is (M^-1 r)_i / (M^-1)_ii.
double leaveOneOut(const Square& inverse, const std::vector<std::vector<double>>& tried) {
  double sum = 0;
  for (const std::vector<double>& r : tried)
    for (std::size_t i = 0; i < r.size(); ++i) {
      double w = 0;
      for (std::size_t j = 0; j < r.size(); ++j) w += inverse.at(i, j) * r[j];
      const double error = w / inverse.at(i, i);
      sum += error * error;
    }
  return std::sqrt(sum / static_cast<double>(tried.size() * inverse.size()));
}

std::vector<std::vector<double>> spreadOver(const std::vector<Image<float>>& off) {
  const std::size_t values = off[0].texels().size();
  const std::size_t step = std::max<std::size_t>(1, values / kTried) | 1;  // odd: all channels
  std::vector<std::vector<double>> tried;
  for (std::size_t v = step / 2; v < values; v += step) {
    std::vector<double> r;
    r.reserve(off.size());
    for (const Image<float>& picture : off) r.push_back(picture.texels()[v]);
    tried.push_back(std::move(r));
  }
  return tried;
}

// w = M^-1 r of every texel, in place of r.
void solveAll(const Square& inverse, std::vector<Image<float>>& off, Progress& progress) {
  const std::size_t n = off.size();
  const int height = off[0].height();
  const auto width = static_cast<std::size_t>(off[0].width()) * off[0].channels();
  progress.begin("residual", height);
  forEachRow(height, static_cast<std::int64_t>(width * n * n), [&](int y) {
    std::vector<float> row(n * width);
    for (std::size_t i = 0; i < n; ++i) {
      float* to = row.data() + i * width;
      for (std::size_t j = 0; j < n; ++j) {
        const auto factor = static_cast<float>(inverse.at(i, j));
        const float* from = off[j].view().row(y);
        for (std::size_t x = 0; x < width; ++x) to[x] += factor * from[x];
      }
    }
    for (std::size_t i = 0; i < n; ++i)
      std::copy_n(row.data() + i * width, width, off[i].view().row(y));
    progress.step();
  });
}

}  // namespace

LightResidual fitResidual(std::vector<Image<float>> off, std::vector<Vec3> lights,
                          Progress& progress) {
  PATINA_CHECK(off.size() == lights.size() && off.size() >= 4);
  LightResidual residual;
  residual.leave_one_out_rms = HUGE_VAL;
  const std::vector<std::vector<double>> tried = spreadOver(off);
  for (const double width : kWidths)
    for (const double ridge : kRidges) {
      const double error = leaveOneOut(smoother(lights, width, ridge), tried);
      if (error >= residual.leave_one_out_rms) continue;
      residual.leave_one_out_rms = error;
      residual.width = width;
      residual.ridge = ridge;
    }
  solveAll(smoother(lights, residual.width, residual.ridge), off, progress);
  residual.lights = std::move(lights);
  residual.weights = std::move(off);
  return residual;
}

Image<float> residualUnder(const LightResidual& residual, const Vec3& l) {
  const Image<float>& first = residual.weights[0];
  Image<float> out(first.width(), first.height(), first.channels());
  const auto width = static_cast<std::size_t>(out.width()) * out.channels();
  std::vector<float> k;
  k.reserve(residual.lights.size());
  for (const Vec3& at : residual.lights)
    k.push_back(static_cast<float>(kernel(at, l, residual.width)));
  forEachRow(out.height(), static_cast<std::int64_t>(width * k.size()), [&](int y) {
    float* to = out.view().row(y);
    for (std::size_t j = 0; j < k.size(); ++j) {
      const float* from = residual.weights[j].view().row(y);
      for (std::size_t x = 0; x < width; ++x) to[x] += k[j] * from[x];
    }
  });
  return out;
}

}  // namespace patina::brdf
