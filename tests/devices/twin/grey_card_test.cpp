// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "devices/twin/specimen.h"

namespace patina::devices::twin {
namespace {

TEST(GreyCard, IsEvenDiffuseAndDoesNotAge) {
  const auto card = makeSpecimen("grey_card", 1);
  for (const double time : {0.0, 1.0}) {
    const SurfaceMaps maps = card->surfaceAt(time, {16, 16});
    for (const float v : maps.diffuse.texels()) ASSERT_EQ(v, 0.5f);
    for (const float v : maps.specular.texels()) ASSERT_EQ(v, 0.0f);
    for (const float v : maps.degree.texels()) ASSERT_EQ(v, 0.0f);
  }
}

}  // namespace
}  // namespace patina::devices::twin
