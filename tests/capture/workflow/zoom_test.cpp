// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/zoom.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(CommonZoom, IsWhatAnyOfThePicturesSays) {
  CommonZoom common;
  common.add({}, "a.jpg");
  common.add({35, 0}, "b.jpg");
  common.add({35.2, 0.5}, "c.jpg");
  EXPECT_EQ(common.zoom().focal_mm, 35);
  EXPECT_EQ(common.zoom().focus_m, 0.5);
}

TEST(CommonZoom, NamesThePictureThatWasTakenAtAnother) {
  CommonZoom common;
  common.add({35, 0.5}, "a.jpg");
  EXPECT_THAT(([&] {
                common.add({50, 0.5}, "b.jpg");
              }),
              ThrowsMessage<WorkflowError>(
                  HasSubstr("b.jpg was taken at 50 mm and a.jpg at 35 mm: leave zoom")));
  EXPECT_THAT(([&] {
                common.add({35, 0.6}, "c.jpg");
              }),
              ThrowsMessage<WorkflowError>(HasSubstr("0.6 m of distance")));
}

TEST(ZoomOf, APictureThatDoesNotSayIsUnknown) {
  const Bytes png = encodePng(testing::plain({8, 8}, 100).view());
  EXPECT_EQ(zoomOf(png).focal_mm, 0);
  EXPECT_EQ(zoomOf(png).focus_m, 0);
}

TEST(AddZoom, KeepsWhatIsKnown) {
  Facts values;
  addZoom(values, {35, 0});
  EXPECT_EQ(values.number("focal_mm"), 35);
  EXPECT_FALSE(values.number("focus_m"));
}

}  // namespace
}  // namespace patina::workflow
