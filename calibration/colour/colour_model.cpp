// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/colour_model.h"

#include <algorithm>
#include <cmath>

#include "calibration/failure.h"
#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

// T is float for pictures, double for fits.
template <class T>
void fill(FitKind kind, T r, T g, T b, T* terms) {
  terms[0] = r, terms[1] = g, terms[2] = b;
  if (kind == FitKind::k4x3) terms[3] = 1;
  if (kind != FitKind::kRoot2 && kind != FitKind::kRoot3) return;
  r = std::max(r, T{0}), g = std::max(g, T{0}), b = std::max(b, T{0});
  terms[3] = std::sqrt(r * g), terms[4] = std::sqrt(g * b), terms[5] = std::sqrt(r * b);
  if (kind != FitKind::kRoot3) return;
  const T cr = std::cbrt(r), cg = std::cbrt(g), cb = std::cbrt(b);
  terms[6] = cr * cg * cg, terms[7] = cg * cb * cb, terms[8] = cr * cb * cb;
  terms[9] = cg * cr * cr, terms[10] = cb * cg * cg, terms[11] = cb * cr * cr;
  terms[12] = cr * cg * cb;
}

}  // namespace

std::string nameOf(FitKind kind) {
  switch (kind) {
    case FitKind::k3x3:
      return "3x3";
    case FitKind::k4x3:
      return "4x3";
    case FitKind::kRoot2:
      return "root2";
    case FitKind::kRoot3:
      return "root3";
  }
  return {};
}

std::optional<FitKind> fitNamed(const std::string& name) {
  for (const FitKind kind : kFitKinds)
    if (nameOf(kind) == name) return kind;
  return std::nullopt;
}

int termCount(FitKind kind) {
  switch (kind) {
    case FitKind::k3x3:
      return 3;
    case FitKind::k4x3:
      return 4;
    case FitKind::kRoot2:
      return 6;
    case FitKind::kRoot3:
      return kTermsMax;
  }
  return 0;
}

void fillTerms(FitKind kind, const Rgb& rgb, std::span<double, kTermsMax> terms) {
  fill(kind, rgb[0], rgb[1], rgb[2], terms.data());
}

Xyz colourOf(const ColourModel& model, const Rgb& rgb) {
  const int count = termCount(model.kind);
  PATINA_CHECK(model.xyz_from_terms.size() == static_cast<std::size_t>(3) * count);
  std::array<double, kTermsMax> terms{};
  fillTerms(model.kind, rgb, terms);
  std::array<double, 3> out{};
  for (int c = 0; c < 3; ++c)
    for (int t = 0; t < count; ++t) out[c] += model.xyz_from_terms[c * count + t] * terms[t];
  return {out[0], out[1], out[2]};
}

void applyColour(ImageView<float> linear, const ColourModel& model, ColourSpace space,
                 double level) {
  if (linear.channels != 3)
    throw CalibrationError(Exit::kBadData, "colours need pictures of 3 channels, these have " +
                                               std::to_string(linear.channels));
  const int count = termCount(model.kind);
  PATINA_CHECK(model.xyz_from_terms.size() == static_cast<std::size_t>(3) * count);
  const Matrix3 out_from_xyz =
      space == ColourSpace::kXyz ? Matrix3{1, 0, 0, 0, 1, 0, 0, 0, 1} : linearSrgbFromXyz();
  std::array<float, 3 * kTermsMax> matrix{};
  for (int t = 0; t < count; ++t) {
    const auto& m = model.xyz_from_terms;
    const auto column = mapped(out_from_xyz, {m[t], m[count + t], m[2 * count + t]});
    for (int c = 0; c < 3; ++c) matrix[c * count + t] = static_cast<float>(level * column[c]);
  }
  const int cost = model.kind == FitKind::kRoot3 ? 120 : 20;
  forEachRow(linear.height, std::int64_t{linear.width} * cost, [&](int y) {
    std::array<float, kTermsMax> terms{};
    for (int x = 0; x < linear.width; ++x) {
      float* rgb = linear.row(y) + static_cast<std::ptrdiff_t>(x) * 3;
      fill(model.kind, rgb[0], rgb[1], rgb[2], terms.data());
      for (int c = 0; c < 3; ++c) {
        float sum = 0;
        for (int t = 0; t < count; ++t) sum += matrix[c * count + t] * terms[t];
        rgb[c] = sum;
      }
    }
  });
}

}  // namespace patina::calibration
