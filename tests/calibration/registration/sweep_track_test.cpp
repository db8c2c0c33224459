// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/sweep_track.h"

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

#include "processing/image/random.h"

namespace patina::calibration {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 128, kHeight = 96;
constexpr std::size_t kLamps = 6;

// Smooth seeded waves, moved, under a lamp that lights one side more.
Image<float> waves(PlacePx shift, std::size_t lamp, std::uint64_t seed = 1) {
  Image<float> out(kWidth, kHeight, 1);
  const double side = 1.05 * static_cast<double>(lamp);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      double light = 0.4;
      for (std::uint64_t k = 0; k < 16; ++k) {
        const double turn = 6.283 * uniform(hashSeed(seed, 1, k)),
                     pace = 0.05 + 0.4 * uniform(hashSeed(seed, 2, k));
        light += 0.02 *
                 std::sin(pace * (std::cos(turn) * (x - shift.x) + std::sin(turn) * (y - shift.y)) +
                          6.283 * uniform(hashSeed(seed, 3, k)));
      }
      light *= 1 + 0.3 * (std::cos(side) * x / kWidth + std::sin(side) * y / kHeight);
      out.at(x, y) = static_cast<float>(light);
    }
  return out;
}

// Something else over this part of the picture, moved along.
Image<float> with(Image<float> picture, const RectPx& part, std::uint64_t seed, PlacePx shift) {
  const Image<float> other = waves(shift, 0, seed);
  for (int y = part.y; y < part.y + part.height; ++y)
    for (int x = part.x; x < part.x + part.width; ++x) picture.at(x, y) = other.at(x, y);
  return picture;
}
constexpr RectPx kPart{32, 16, 48, 48};

class Sweep {
 public:
  explicit Sweep(PlacePx shift = {}, std::uint64_t seed = 1) : shift_(shift) {
    for (std::size_t lamp = 0; lamp < kLamps; ++lamp) set(lamp, waves(shift, lamp, seed));
  }
  Sweep& set(std::size_t lamp, Image<float> picture) {
    pictures_[lamp] = std::move(picture);
    return *this;
  }
  Sweep& cover(std::size_t lamps, std::uint64_t seed) {
    for (std::size_t lamp = 0; lamp < lamps; ++lamp)
      set(lamp, with(pictures_[lamp], kPart, seed, shift_));
    return *this;
  }
  const Image<float>& picture(std::size_t lamp) const { return pictures_.at(lamp); }
  Sweep& without(std::size_t lamp) {
    pictures_.erase(lamp);
    return *this;
  }
  SweepPoses in(SweepTrack& track) const {
    std::vector<SweepFrame> frames;
    for (const auto& [lamp, picture] : pictures_) frames.push_back({lamp, picture.view()});
    Progress progress;
    return track.add(frames, progress);
  }

 private:
  PlacePx shift_;
  std::map<std::size_t, Image<float>> pictures_;
};

void expectShift(const Motion& pose, PlacePx shift) {
  EXPECT_NEAR(pose[2], shift.x, 0.05);
  EXPECT_NEAR(pose[5], shift.y, 0.05);
}
int used(const SweepPoses& poses) {
  return static_cast<int>(std::ranges::count_if(poses.frames, &SweepFramePose::used));
}

TEST(SweepTrack, GivesAllLampsOnePose) {
  SweepTrack track({});
  EXPECT_EQ(used(Sweep().in(track)), 6);
  const SweepPoses poses = Sweep({0.7, -0.4}).in(track);
  ASSERT_TRUE(poses.frame_from_reference);
  expectShift(*poses.frame_from_reference, {0.7, -0.4});
  for (const SweepFramePose& one : poses.frames) {
    EXPECT_TRUE(one.used && !one.changed && !one.apart);
    EXPECT_EQ(one.pose.frame_from_reference, *poses.frame_from_reference);
  }
}

TEST(SweepTrack, LeavesOutWhatIsInTheWayUnderFewLamps) {
  SweepTrack track({});
  Sweep().in(track);
  const SweepPoses poses = Sweep({0.5, 0}).cover(2, 9).in(track);
  EXPECT_FALSE(poses.frames[0].used || poses.frames[1].used);
  EXPECT_EQ(poses.frames[0].pose.verdict, Verdict::kCovered);
  EXPECT_EQ(used(poses), 4);
  expectShift(*poses.frame_from_reference, {0.5, 0});
}

TEST(SweepTrack, TakesWhatMostLampsSeeForAgeing) {
  SweepTrack track({});
  Sweep().in(track);
  SweepPoses poses = Sweep({0.5, 0}).cover(5, 9).in(track);
  EXPECT_EQ(used(poses), 6);
  EXPECT_TRUE(poses.frames[0].changed && !poses.frames[5].changed);
  expectShift(*poses.frame_from_reference, {0.5, 0});
  poses = Sweep({1.1, 0.3}).cover(5, 9).in(track);
  for (const SweepFramePose& one : poses.frames) EXPECT_TRUE(one.used && !one.changed);
  expectShift(*poses.frame_from_reference, {1.1, 0.3});
}

TEST(SweepTrack, FogUnderMostLampsIsNoAgeing) {
  const auto fogged = [](Image<float> picture) {
    for (float& level : picture.texels()) level = 0.5f * level + 0.4f;
    return picture;
  };
  SweepTrack track({});
  Sweep().in(track);
  Sweep fog, changing = Sweep().cover(5, 9);
  for (std::size_t lamp = 0; lamp < kLamps; ++lamp) fog.set(lamp, fogged(waves({}, lamp)));
  const SweepPoses poses = fog.in(track);
  EXPECT_EQ(used(poses), 0);
  EXPECT_EQ(poses.frames[0].pose.verdict, Verdict::kFogged);
  EXPECT_EQ(used(fog.in(track)), 6) << "it stays";
  EXPECT_EQ(used(fog.in(track)), 6);
  SweepTrack other({});
  Sweep().in(other);
  EXPECT_EQ(used(changing.set(5, fogged(waves({}, 5))).in(other)), 6) << "one that lost contrast";
}

TEST(SweepTrack, HoldsNothingAgainstALampTwice) {
  SweepTrack track({});
  Sweep().in(track);
  Sweep().cover(1, 9).in(track);
  const SweepPoses poses = Sweep().cover(1, 9).in(track);
  EXPECT_TRUE(poses.frames[0].used && poses.frames[0].changed);
}

TEST(SweepTrack, OfThreeLampsAHandCanCoverAll) {
  SweepTrack track({});
  const auto few = [](Sweep sweep) { return sweep.without(3).without(4).without(5); };
  few(Sweep()).in(track);
  EXPECT_EQ(used(few(Sweep().cover(3, 9)).in(track)), 0);
  EXPECT_EQ(used(few(Sweep()).in(track)), 3);
}

TEST(SweepTrack, AnotherSceneUnderAllLampsHasNoPose) {
  SweepTrack track({});
  Sweep().in(track);
  const SweepPoses lost = Sweep({}, 7).in(track);
  EXPECT_FALSE(lost.frame_from_reference);
  EXPECT_EQ(used(lost), 0);
  EXPECT_THAT(lost.frames[0].pose.reason, HasSubstr("blocks agree"));
  EXPECT_EQ(used(Sweep({0.3, 0}).in(track)), 6) << "it is back";
}

TEST(SweepTrack, OneLampOfManyDoesNotTellTheOthersPose) {
  SweepTrack track({});
  Sweep().in(track);
  const SweepPoses poses = Sweep({0.4, 0}, 7).set(0, waves({0.4, 0}, 0)).in(track);
  EXPECT_FALSE(poses.frame_from_reference);
  EXPECT_EQ(used(poses), 0);
}

// A card that stays takes the right of the picture: the camera's pose is known.
constexpr int kCardFrom = 72;
TrackOptions besideACard() {
  TrackOptions options;
  options.outside = Image<std::uint8_t>(kWidth, kHeight, 1);
  for (int y = 0; y < kHeight; ++y)
    for (int x = kCardFrom; x < kWidth; ++x) options.outside.at(x, y) = 255;
  return options;
}
Sweep sweepBesideACard(PlacePx shift, std::uint64_t specimen, float contrast = 1) {
  Sweep out(shift);
  for (std::size_t lamp = 0; lamp < kLamps; ++lamp) {
    Image<float> picture = waves(shift, lamp);
    const Image<float> other = waves(shift, lamp, specimen);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kCardFrom - 2; ++x)
        picture.at(x, y) = contrast * other.at(x, y) + 0.4f * (1 - contrast);
    out.set(lamp, std::move(picture));
  }
  return out;
}

TEST(SweepTrack, BesideACardTheSpecimenMayChangeCompletelyAtOnce) {
  SweepTrack track(besideACard());
  sweepBesideACard({}, 3).in(track);
  for (std::uint64_t k = 1; k < 5; ++k) {
    const PlacePx shift{0.3 * static_cast<double>(k), 0.1};
    const SweepPoses poses = sweepBesideACard(shift, 3 + k).in(track);
    EXPECT_EQ(used(poses), 6) << k;
    ASSERT_TRUE(poses.frame_from_reference) << k;
    expectShift(*poses.frame_from_reference, shift);
  }
}

TEST(SweepTrack, BesideACardThatIsClearLossOfContrastIsAgeing) {
  SweepTrack track(besideACard());
  sweepBesideACard({}, 3).in(track);
  const SweepPoses poses = sweepBesideACard({}, 3, 0.6f).in(track);
  EXPECT_EQ(used(poses), 6);
  EXPECT_EQ(poses.frames[0].pose.verdict, Verdict::kFogged);
}

// Thirteen lamps, of which three see the specimen as it was: the card is seen under all of them.
TEST(SweepTrack, LampsThatAreNotTrustedTellThePoseWhereTheOthersAreTooFew) {
  const auto sweep = [](PlacePx shift, std::uint64_t specimen, std::size_t unchanged) {
    Sweep out(shift);
    const Sweep before = sweepBesideACard(shift, 3), now = sweepBesideACard(shift, specimen);
    for (std::size_t lamp = 0; lamp < 13; ++lamp)
      out.set(lamp, (lamp < unchanged ? before : now).picture(lamp % kLamps));
    return out;
  };
  SweepTrack track(besideACard());
  sweep({}, 3, 13).in(track);
  const SweepPoses poses = sweep({0.5, 0.2}, 4, 3).in(track);
  EXPECT_EQ(used(poses), 13);
  ASSERT_TRUE(poses.frame_from_reference);
  expectShift(*poses.frame_from_reference, {0.5, 0.2});
}

// Its edges tell the pose as before.
TEST(SweepTrack, ACardThatLosesContrastForGoodCostsOneSweep) {
  const auto faded = [](PlacePx shift) {
    Sweep out(shift);
    for (std::size_t lamp = 0; lamp < kLamps; ++lamp) {
      Image<float> picture = waves(shift, lamp);
      for (float& level : picture.texels()) level = 0.6f * level + 0.2f;
      out.set(lamp, std::move(picture));
    }
    return out;
  };
  SweepTrack track(besideACard());
  Sweep().in(track);
  EXPECT_EQ(used(faded({0.2, 0}).in(track)), 0);
  for (const double x : {0.4, 0.6, 0.8}) EXPECT_EQ(used(faded({x, 0}).in(track)), 6) << x;
}

TEST(SweepTrack, ABumpWithinASweepLeavesEachLampWhereItSaysItself) {
  SweepTrack track({});
  Sweep().in(track);
  Sweep bumped;
  bumped.set(0, with(waves({}, 0), kPart, 9, {}));
  bumped.set(4, waves({4, 3}, 4)).set(5, waves({4, 3}, 5));
  const SweepPoses poses = bumped.in(track);
  expectShift(poses.frames[1].pose.frame_from_reference, {});
  for (const std::size_t lamp : {4u, 5u}) {
    expectShift(poses.frames[lamp].pose.frame_from_reference, {4, 3});
    EXPECT_TRUE(poses.frames[lamp].used && poses.frames[lamp].apart);
  }
  EXPECT_FALSE(poses.frames[0].used) << "where it lies is not known";
  const SweepPoses next = Sweep({4, 3}).in(track);
  EXPECT_EQ(used(next), 6);
  expectShift(*next.frame_from_reference, {4, 3});
}

TEST(SweepTrack, DoesNotBelieveOneLampThatSaysItLiesElsewhere) {
  SweepTrack track({});
  Sweep().in(track);
  const SweepPoses poses = Sweep().set(2, waves({4, 3}, 2)).in(track);
  EXPECT_FALSE(poses.frames[2].used || poses.frames[2].apart);
  EXPECT_THAT(poses.frames[2].pose.reason, HasSubstr("elsewhere"));
  EXPECT_EQ(used(poses), 5);
  expectShift(*poses.frame_from_reference, {});
}

TEST(SweepTrack, ALampThatComesLaterLiesWhereTheOthersAre) {
  SweepTrack track({});
  Sweep().without(2).in(track);
  SweepPoses poses = Sweep({0.8, 0.2}).in(track);
  expectShift(poses.frames[2].pose.frame_from_reference, {0.8, 0.2});
  poses = Sweep({0.2, 0.5}).in(track);
  EXPECT_EQ(used(poses), 6);
  expectShift(poses.frames[2].pose.frame_from_reference, {0.2, 0.5});
}

TEST(SweepTrack, ALampThatShowsNothingIsPlacedByTheOthers) {
  const Image<float> blank(kWidth, kHeight, 1, 0.5f);
  SweepTrack track({});
  Sweep().set(3, blank).in(track);
  for (const double x : {0.4, 0.8}) {
    const SweepPoses poses = Sweep({x, 0}).set(3, blank).in(track);
    EXPECT_TRUE(poses.frames[3].used);
    EXPECT_EQ(poses.frames[3].pose.frame_from_reference, *poses.frame_from_reference);
    expectShift(*poses.frame_from_reference, {x, 0});
  }
}

}  // namespace
}  // namespace patina::calibration
