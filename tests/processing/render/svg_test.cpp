// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/svg.h"

#include <gmock/gmock.h>

namespace patina::render {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(SvgSurface, WritesEachShape) {
  SvgSurface svg({300, 200});
  svg.line({{1, 2}, {3.5, 4.25}}, 1.5, {255, 0, 128}, 4);
  svg.disc({10, 20}, 3, {0, 0, 0, 0.5});
  svg.polygon({{0, 0}, {1, 0}, {1, 1}}, {1, 2, 3});
  svg.text({5, 6}, "axis", {.align = Align::kMiddle, .upwards = true});
  const std::string text = svg.finish();
  EXPECT_THAT(text, HasSubstr("viewBox=\"0 0 300 200\""));
  EXPECT_THAT(text, HasSubstr("points=\"1,2 3.5,4.25\""));
  EXPECT_THAT(text, HasSubstr("stroke=\"#ff0080\""));
  EXPECT_THAT(text, HasSubstr("fill-opacity=\"0.5\""));
  EXPECT_THAT(text, HasSubstr("text-anchor=\"middle\""));
  EXPECT_THAT(text, HasSubstr("rotate(-90 5 6)"));
}

TEST(SvgSurface, LetsNoTextEscapeIntoThePage) {
  SvgSurface svg({300, 200});
  svg.text({0, 0}, "</svg><script>\"&'\x01", {});
  EXPECT_THAT(svg.finish(), HasSubstr("&lt;/svg&gt;&lt;script&gt;&quot;&amp;'<"));
  EXPECT_THAT(svg.finish(), Not(HasSubstr("<script")));
}

}  // namespace
}  // namespace patina::render
