// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/near_lights.h"

#include <gmock/gmock.h>

#include <cmath>

#include "capture/workflow/failure.h"
#include "capture/workflow/view_calibration.h"
#include "capture/workflow/vignetting_calibration.h"
#include "tests/calibration/lamps/lamp_ring.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using calibration::LampRing;
using calibration::RingTwin;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

class NearLights : public ::testing::Test {
 protected:
  NearLights() {
    testing::makeRun(archive_, {{{testing::MadeShot{}}}});
    request_.camera = "cam0";
    request_.command = "patina calibrate near-lights";
  }
  // Pictures of every lamp, and where the twin sees its plane.
  void plant(const LampRing& ring, const std::string& name, Nanoseconds exposure) {
    RingTwin twin(ring);
    std::filesystem::create_directories(folder_ / name);
    for (std::size_t lamp = 0; lamp < twin.lamps(); ++lamp)
      writeExr(folder_ / name / ("l" + std::to_string(lamp) + ".exr"),
               twin.pictureOf(lamp, exposure).view());
    const calibration::twin::SampleGrid& grid = twin.maker().grid();
    const SizePx size = parseSize(ring.size);
    sight_ = {};
    for (int y = 4; y < size.height; y += size.height / 8)
      for (int x = 4; x < size.width; x += size.width / 8) {
        const std::size_t k = grid.index(x, y);
        sight_.plane_mm.push_back({grid.x_mm[k], grid.y_mm[k], 0});
        sight_.seen_px.push_back({static_cast<double>(x), static_cast<double>(y)});
      }
    const double focal = 1.2 * size.width;
    lens_ = {size, focal, focal, (size.width - 1) / 2.0, (size.height - 1) / 2.0, -0.12, 0.03,
             0,    0,     0};
    request_.places.push_back({folder_ / name, {}, {}});
  }
  void keepLensAndView() {
    LensCalibration lens;
    lens.fit.lens = lens_;
    lens.pictures.size = lens_.size;
    lens.pictures.taken = testing::now();
    keepLens(archive_, lens, {}, "cam0", testing::now());
    ViewCalibration view;
    view.lens = lens_;
    view.fit = fitView(lens_, sight_);
    view.taken = testing::now();
    ViewRequest request;
    request.camera = "cam0";
    keepView(archive_, view, request, testing::now());
  }
  void keepFallOff() {
    VignettingCalibration made;
    made.fit.vignetting = {-0.3, 0, 0};
    made.size = lens_.size;
    made.taken = testing::now();
    keepVignetting(archive_, made, {}, "cam0", testing::now());
  }
  NearLightsOutcome make() {
    Progress progress;
    return makeNearLights(archive_, request_, testing::now(), progress);
  }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
  NearLightsRequest request_;
  calibration::PlaneSight sight_;
  calibration::Lens lens_;
};

TEST_F(NearLights, OfTheTwinAreFoundByACardThroughTheView) {
  LampRing ring;
  ring.lamps_mm = {{180, -90, 260}};
  ring.specimen = "grey_card";
  ring.size = "256x256";
  plant(ring, "card", std::chrono::milliseconds(20));
  request_.card = {{8, 8, 240, 150}};
  EXPECT_THAT(([&] { make(); }), ThrowsMessage<WorkflowError>(HasSubstr("patina calibrate view")));
  keepLensAndView();
  EXPECT_THAT(make().notes, ::testing::ElementsAre(HasSubstr("patina calibrate vignetting")));
  keepFallOff();
  const NearLightsOutcome found = make();
  EXPECT_TRUE(found.of_plane);
  EXPECT_TRUE(found.notes.empty());
  ASSERT_EQ(found.lamps.size(), 1u);
  const double off = distance(found.lamps[0].light.position_mm, ring.lamps_mm[0]);
  std::printf("near lamp by a card through the view: %.1f mm off\n", off);
  EXPECT_LT(off, 0.05 * 330);
  const KeptCalibration kept = keepNearLights(archive_, request_, found, testing::now());
  EXPECT_EQ(kept.row.kind, "near_lights");
  EXPECT_EQ(Facts::parse(kept.row.value_json).number("l0.exr.x_mm"),
            found.lamps[0].light.position_mm[0]);
}

TEST_F(NearLights, OfTheTwinAreFoundByASphereAtTwoPlaces) {
  LampRing ring;
  ring.lamps_mm = {{180, -90, 260}, {-100, 120, 350}};
  ring.size = "320x320";
  ring.pose.distant = false;
  ring.pose.position_mm = {0, 0, 150};
  request_.sphere_radius_mm = 12;
  for (const std::array<double, 3>& middle : {std::array<double, 3>{-25, 14, 12}, {25, -14, 12}}) {
    ring.targets = {calibration::mirrorSphere(middle, 24)};
    plant(ring, "place" + std::to_string(request_.places.size()), std::chrono::microseconds(200));
  }
  EXPECT_THAT(([&] { make(); }), ThrowsMessage<WorkflowError>(HasSubstr("patina calibrate lens")));
  keepLensAndView();
  const NearLightsOutcome found = make();
  EXPECT_TRUE(found.of_plane);
  for (std::size_t i = 0; i < 2; ++i) {
    const double off = distance(found.lamps[i].light.position_mm, ring.lamps_mm[i]);
    std::printf("near lamp by a sphere at two places: %.1f mm off\n", off);
    EXPECT_LT(off, 20);
  }
  request_.places.pop_back();
  EXPECT_THAT(([&] { make(); }), ThrowsMessage<WorkflowError>(HasSubstr("two places")));
}

}  // namespace
}  // namespace patina::workflow
