// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/ward.h"

#include "tests/processing/brdf/lobes.h"

namespace patina::brdf {
namespace {

TEST(Ward, DerivativesAreThoseOfItsValue) {
  expectDerivativesOf([](const LobeCosines& c, float r) { return wardLobe(c, r); });
}

TEST(Ward, IsReciprocal) {
  expectReciprocal([](const LobeCosines& c, float r) { return wardLobe(c, r); });
}

TEST(Ward, AtNormalIncidenceIsOneOverFourPiAlphaSquared) {
  EXPECT_NEAR(wardLobe({1, 1, 1, 1}, 0.2f).value, 1 / (4 * M_PI * 0.04), 1e-4);
}

TEST(Ward, ANarrowLobeReflectsAllAndNoneReflectsMore) {
  const auto albedo = [](double n_v, float alpha) {
    return directionalAlbedo(
        n_v, [&](const LobeCosines& c, double) { return double{wardLobe(c, alpha).value}; });
  };
  EXPECT_NEAR(albedo(1, 0.05f), 1, 0.01);
  EXPECT_NEAR(albedo(0.6, 0.05f), 1, 0.02);
  for (const float alpha : {0.05f, 0.2f, 0.5f, 1.0f})
    for (const double n_v : {0.05, 0.3, 0.7, 1.0}) EXPECT_LE(albedo(n_v, alpha), 1.001) << alpha;
}

TEST(Ward, AnisotropicWithEqualRoughnessesIsTheIsotropicOne) {
  const Vec3 h = normalized({0.2f, -0.1f, 1});
  EXPECT_NEAR(wardAnisotropic(h, 0.8f, 0.3f, 0.3f), wardLobe({1, 1, h.z, 0.8f}, 0.3f).value, 1e-5);
}

TEST(Ward, AnisotropicIsWiderAlongTheRougherAxisAndKeepsTheEnergy) {
  EXPECT_GT(wardAnisotropic(normalized({0.3f, 0, 1}), 0.9f, 0.4f, 0.1f),
            5 * wardAnisotropic(normalized({0, 0.3f, 1}), 0.9f, 0.4f, 0.1f));
  const double albedo = directionalAlbedo(1, [&](const LobeCosines& c, double phi) {
    const auto s = static_cast<float>(std::sqrt(1 - double{c.n_h} * c.n_h));
    const Vec3 h{s * static_cast<float>(std::cos(phi)), s * static_cast<float>(std::sin(phi)),
                 c.n_h};
    return double{wardAnisotropic(h, c.v_h, 0.1f, 0.04f)};
  });
  EXPECT_NEAR(albedo, 1, 0.02);
}

}  // namespace
}  // namespace patina::brdf
