// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/field_frames.h"

#include <gmock/gmock.h>

#include "capture/workflow/albedo_calibration.h"
#include "capture/workflow/failure.h"
#include "capture/workflow/frame_chain.h"
#include "capture/workflow/gain_field_calibration.h"
#include "capture/workflow/ttf_product.h"
#include "processing/image/encoding.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::MadeShot;
using testing::TempFolder;
using ::testing::ThrowsMessage;

constexpr SizePx kSize{24, 16};
const float kLevel = linearFromSrgb(100 / 255.0f);  // of every frame

// Light of a lamp: `left` at the left edge, `right` at the right one, blue half of that.
Image<float> ramp(float left, float right) {
  Image<float> field(kSize.width, kSize.height, 3);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      for (int c = 0; c < 3; ++c)
        field.at(x, y, c) = (c == 2 ? 0.5f : 1.0f) *
                            (left + (right - left) * static_cast<float>(x) / (kSize.width - 1));
  return field;
}

class FieldFramesOf : public ::testing::Test {
 protected:
  void makeRun(const std::string& light) {
    MadeShot shot;
    shot.light = light;
    testing::makeRun(archive_, {{{shot}}, {{shot}}});
  }
  KeptCalibration keepField(const std::string& lamp, Image<float> painted,
                            Nanoseconds exposure = std::chrono::milliseconds(20),
                            std::chrono::hours ago = {}, bool flat = false) {
    GainFieldOutcome made;
    made.painted = std::move(painted);
    made.from.row = rowOf(lamp, exposure, ago);
    made.from.flat = flat;
    return keepGainField(archive_, {}, made, testing::now());
  }
  static db::CalibrationRow rowOf(const std::string& light, Nanoseconds exposure,
                                  std::chrono::hours ago) {
    db::CalibrationRow row;
    row.device_id = "cam0";
    row.light_state = light;
    row.exposure = exposure;
    row.iso = 100;
    row.size = kSize;
    row.utc = testing::now() - ago;
    return row;
  }
  TtfOutcome build(FieldUse field = FieldUse::kWhereItFits, bool albedo = false,
                   bool stale = false) {
    TtfRequest request;
    request.run = "latest";
    request.field = field;
    request.albedo = albedo;
    request.correction.stale = stale;
    Progress progress;
    return makeTtf(archive_, request, testing::now(), progress);
  }
  static float at(const TtfOutcome& outcome, int x, int c = 1) {
    return ttf::TtfReader(outcome.path).linearFrame(0).at(x, 7, c);
  }
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
};

TEST_F(FieldFramesOf, ALampAreEvenWhereItsFieldIsKnownAndSayWhichOneServed) {
  makeRun("key");
  const KeptCalibration kept = keepField("key", ramp(0.2f, 0.6f));
  const TtfOutcome even = build();
  EXPECT_NEAR(at(even, 0), kLevel * 0.4 / 0.2, 1e-4);
  EXPECT_NEAR(at(even, 23), kLevel * 0.4 / 0.6, 1e-4);
  EXPECT_NEAR(at(even, 0, 2), kLevel * 0.4 / 0.2, 1e-4) << "each channel by its own mean";
  EXPECT_THAT(even.calibrations, ElementsAre("gain_field 1: 0.0 days away"));
  EXPECT_THAT(even.product.input_sha256s, ::testing::Contains(kept.row.sha256));
  EXPECT_THAT(even.product.options_json, HasSubstr("\"field\":true"));
  EXPECT_NEAR(at(build(FieldUse::kNone), 0), kLevel, 1e-4);
}

TEST_F(FieldFramesOf, SeveralLampsAreDividedByTheSumOfTheirLightAtOneExposure) {
  makeRun("fill+key");
  keepField("fill", ramp(0.3f, 0.1f));
  // Twice the light because it was exposed for twice the time.
  keepField("key", ramp(0.2f, 1.4f), std::chrono::milliseconds(40));
  const TtfOutcome even = build();
  EXPECT_NEAR(at(even, 0), kLevel * 0.6 / 0.4, 1e-4);
  EXPECT_NEAR(at(even, 23), kLevel * 0.6 / 0.8, 1e-4);
  EXPECT_THAT(even.calibrations, ::testing::SizeIs(2));
}

TEST_F(FieldFramesOf, ALampWithoutAFieldAreLeftAsTheyAreAndThatIsSaid) {
  makeRun("fill+key");
  EXPECT_THAT(build().calibrations_left, IsEmpty()) << "no field was ever made: nothing to say";
  keepField("key", ramp(0.2f, 0.6f));
  const TtfOutcome uneven = build();
  EXPECT_NEAR(at(uneven, 0), kLevel, 1e-4);
  EXPECT_THAT(uneven.calibrations_left,
              ElementsAre(HasSubstr("lit by key, not fill; shoot a white card under fill alone")));
  EXPECT_THAT(([&] { build(FieldUse::kAsked); }),
              ThrowsMessage<WorkflowError>(HasSubstr("patina calibrate field")));
}

TEST_F(FieldFramesOf, AFieldOfLongAgoOrThroughAFlatIsRefusedWithWhatToShoot) {
  makeRun("key");
  keepField("key", ramp(0.2f, 0.6f), std::chrono::milliseconds(20), std::chrono::hours(24 * 40));
  EXPECT_THAT(build().calibrations_left,
              ElementsAre(HasSubstr("gain_field 1: 40 days away, at most 30; shoot a white card")));
  const TtfOutcome stale = build(FieldUse::kWhereItFits, false, true);
  EXPECT_NEAR(at(stale, 0), kLevel * 2, 1e-4);
  const db::ArchiveReader reader(archive_);
  EXPECT_EQ(reader.calibrations("gain_field").size(), 1u);
  keepField("key", ramp(0.2f, 0.6f), std::chrono::milliseconds(20), {}, true);
  EXPECT_THAT(build().calibrations_left,
              ElementsAre(HasSubstr("gain_field 2: made through a flat that these frames do not")));
}

TEST_F(FieldFramesOf, AnAlbedoScaleAreReflectanceWhateverTheirExposure) {
  makeRun("key");
  EXPECT_THAT(([&] { build(FieldUse::kWhereItFits, true); }),
              ThrowsMessage<WorkflowError>(HasSubstr("patina calibrate albedo")));
  const KeptCalibration field = keepField("key", ramp(0.2f, 0.6f));
  AlbedoOutcome made;
  made.scale.channels = 3;
  made.scale.scale = {0.4, 0.4, 0.4};
  made.from.row = rowOf("key", std::chrono::milliseconds(40), {});
  made.field_sha256 = field.row.sha256;
  keepAlbedo(archive_, {}, made, testing::now());
  keepField("key", ramp(0.1f, 0.1f));  // newer, but not the one the scale goes with
  const TtfOutcome absolute = build(FieldUse::kWhereItFits, true);
  EXPECT_NEAR(at(absolute, 0), kLevel * 2 * 0.4 / 0.2, 1e-4);
  EXPECT_THAT(absolute.calibrations,
              ElementsAre("albedo 2: 0.0 days away", "gain_field 1: 0.0 days away"));
  EXPECT_THAT(absolute.product.options_json, HasSubstr("\"albedo\":true"));
}

// Between the field's pictures and the run, and from shot to shot.
TEST_F(FieldFramesOf, WhatALampLostSinceItsFieldIsUndoneByThePatch) {
  MadeShot shot;
  shot.checks = {testing::check("y", 0.9, "learn")};
  shot.checks[0].baseline = 0;
  testing::makeRun(archive_, {{{shot}}});
  GainFieldOutcome made;
  made.painted = ramp(0.4f, 0.4f);
  made.from.row = rowOf("key", std::chrono::milliseconds(40), {});
  made.from.patch = ChannelLevels{1.0, 1.0, 1.0};  // of half the exposure: 0.5
  keepGainField(archive_, {}, made, testing::now());
  const db::ArchiveReader reader(archive_);
  Progress progress;
  FrameRequest white;
  white.white = true;
  FrameChain chain(reader, reader.runs().back(), white, progress);
  EXPECT_NEAR(chain.source().next()->linear.at(5, 5), kLevel / 0.9 * 2 / 0.4, 1e-4);
  EXPECT_TRUE(chain.frames().held_to_patch);
  EXPECT_NEAR(at(build(), 5), kLevel, 1e-4) << "what is only made even is not absolute";
}

TEST_F(FieldFramesOf, AnAlbedoScaleWhoseFieldIsGoneIsRefused) {
  makeRun("key");
  AlbedoOutcome made;
  made.scale.channels = 3;
  made.scale.scale = {1, 1, 1};
  made.from.row = rowOf("key", std::chrono::milliseconds(20), {});
  made.field_sha256 = std::string(64, 'a');
  keepAlbedo(archive_, {}, made, testing::now());
  EXPECT_THAT(([&] { build(FieldUse::kWhereItFits, true); }),
              ThrowsMessage<WorkflowError>(HasSubstr("is not in the archive")));
}

TEST(EvenLightOf, KeepsTheLevelAtThePlaceThatIsToHold) {
  const EvenLight light = evenLightOf({ramp(0.2f, 0.6f), {}, ""}, calibration::PlacePx{23.2, 5});
  EXPECT_NEAR(light.scale.scale[0], 0.6, 1e-6);
  EXPECT_NEAR(light.scale.scale[2], 0.3, 1e-6);
}

}  // namespace
}  // namespace patina::workflow
