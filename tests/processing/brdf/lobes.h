// SPDX-License-Identifier: GPL-3.0-or-later
// What every lobe is held to: derivatives by finite differences, reciprocity, energy by quadrature.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "processing/brdf/lobe.h"
#include "processing/image/random.h"

namespace patina::brdf {

template <class LobeOf>
void expectDerivativesOf(const LobeOf& lobe_of) {
  for (std::uint64_t i = 0; i < 300; ++i) {
    const auto draw = [&](int k, double low) {
      return static_cast<float>(low + (0.98 - low) * uniform(hashSeed(3, i, k)));
    };
    const LobeCosines at{draw(0, 0.2), draw(1, 0.2), draw(2, 0.6), draw(3, 0.3)};
    const float r = draw(4, 0.15);
    const Lobe lobe = lobe_of(at, r);
    const auto close = [&](float slope, auto move) {
      const float h = 2e-3f;
      LobeCosines up = at, down = at;
      float r_up = r, r_down = r;
      move(up, r_up, h);
      move(down, r_down, -h);
      const double numeric =
          (double{lobe_of(up, r_up).value} - double{lobe_of(down, r_down).value}) / (2 * h);
      EXPECT_NEAR(slope, numeric, 0.01 * std::abs(numeric) + 0.02 * lobe.value + 1e-4) << i;
    };
    close(lobe.by_n_l, [](LobeCosines& c, float&, float h) { c.n_l += h; });
    close(lobe.by_n_v, [](LobeCosines& c, float&, float h) { c.n_v += h; });
    close(lobe.by_n_h, [](LobeCosines& c, float&, float h) { c.n_h += h; });
    close(lobe.by_log_r / r, [](LobeCosines&, float& rough, float h) { rough += h; });
  }
}

// Helmholtz: light and view may change places.
template <class LobeOf>
void expectReciprocal(const LobeOf& lobe_of) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const auto draw = [&](int k) {
      return static_cast<float>(0.02 + 0.98 * uniform(hashSeed(4, i, k)));
    };
    const LobeCosines there{draw(0), draw(1), draw(2), draw(3)};
    LobeCosines back = there;
    std::swap(back.n_l, back.n_v);
    const float one_way = lobe_of(there, draw(4)).value, other = lobe_of(back, draw(4)).value;
    ASSERT_NEAR(one_way, other, 1e-5f * std::max(1.0f, one_way)) << i;
  }
}

// The share of light from v that leaves: over half vectors, dl = 4 (v.h) dh.
template <class ValueOf>
double directionalAlbedo(double n_v, const ValueOf& value_of) {
  constexpr int kRings = 1500, kColumns = 64;
  const double sin_v = std::sqrt(1 - n_v * n_v);
  double sum = 0;
  for (int i = 0; i < kRings; ++i) {
    const double theta = (i + 0.5) / kRings * M_PI / 2;
    for (int j = 0; j < kColumns; ++j) {
      const double phi = 2 * M_PI * (j + 0.5) / kColumns;
      const double v_h = sin_v * std::sin(theta) * std::cos(phi) + n_v * std::cos(theta);
      const double n_l = 2 * v_h * std::cos(theta) - n_v;
      if (v_h <= 0 || n_l <= 0) continue;
      const LobeCosines c{static_cast<float>(n_l), static_cast<float>(n_v),
                          static_cast<float>(std::cos(theta)), static_cast<float>(v_h)};
      sum += value_of(c, phi) * n_l * 4 * v_h * std::sin(theta);
    }
  }
  return sum * (M_PI / 2 / kRings) * (2 * M_PI / kColumns);
}

}  // namespace patina::brdf
