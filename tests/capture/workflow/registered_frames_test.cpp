// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/registered_frames.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "calibration/failure.h"
#include "processing/image/random.h"

namespace patina::workflow {
namespace {

using calibration::PlacePx;
using ::testing::HasSubstr;

// Smooth seeded waves, moved.
Image<float> waves(PlacePx shift, std::uint64_t seed = 1) {
  Image<float> out(128, 96, 3);
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
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = static_cast<float>(light * (1 + 0.1 * c));
    }
  return out;
}

class Planted final : public ttf::FrameSource {
 public:
  explicit Planted(std::deque<Image<float>> frames) : frames_(std::move(frames)) {}
  std::int64_t count() const override { return static_cast<std::int64_t>(frames_.size()); }
  std::optional<ttf::SourceFrame> next() override {
    if (frames_.empty()) return std::nullopt;
    ttf::SourceFrame frame;
    frame.time_s = 10.0 * given_++;
    frame.linear = std::move(frames_.front());
    frames_.pop_front();
    return frame;
  }

 private:
  std::deque<Image<float>> frames_;
  int given_ = 0;
};

std::vector<ttf::SourceFrame> allOf(RegisteredFrames& frames) {
  std::vector<ttf::SourceFrame> all;
  while (std::optional<ttf::SourceFrame> frame = frames.next()) all.push_back(std::move(*frame));
  return all;
}

double largestDifference(const Image<float>& a, const Image<float>& b, int margin) {
  double most = 0;
  for (int y = margin; y < a.height() - margin; ++y)
    for (int x = margin; x < a.width() - margin; ++x)
      most = std::max<double>(most, std::abs(a.at(x, y, 1) - b.at(x, y, 1)));
  return most;
}

TEST(RegisteredFrames, ShowsTheSamePlaceInEveryTexel) {
  Planted source({waves({}), waves({0.4, -0.3}), waves({0.9, 0.6}), waves({1.6, 1.2})});
  Progress progress;
  RegisteredFrames frames(source, {}, std::nullopt, progress);
  const std::vector<ttf::SourceFrame> all = allOf(frames);
  ASSERT_EQ(all.size(), 4u);
  for (const ttf::SourceFrame& frame : all)
    EXPECT_LT(largestDifference(frame.linear, all[0].linear, 6), 0.006) << frame.time_s;
  EXPECT_GT(largestDifference(waves({1.6, 1.2}), waves({}), 6), 0.05) << "before";
  const RegistrationReport& report = frames.report();
  EXPECT_EQ(report.refused, 0);
  EXPECT_EQ(report.seen_by_all, (RectPx{0, 1, 126, 93}));
  EXPECT_NEAR(report.largest_move_px, 2.0, 0.05);
}

TEST(RegisteredFrames, LeavesOutAndNamesWhatCannotBeTrusted) {
  Planted source({waves({}), waves({}, 7), waves({0.2, 0.1})});
  Progress progress;
  RegisteredFrames frames(source, {}, std::nullopt, progress);
  const std::vector<ttf::SourceFrame> all = allOf(frames);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1].time_s, 20);
  EXPECT_EQ(frames.report().refused, 1);
  EXPECT_THAT(refusedFrames(frames.report()), HasSubstr("1 of 3 frames refused: 1 (lost: only "));
  EXPECT_THAT(refusedFrames(frames.report()), HasSubstr("% of the blocks agree, wanted 50 %"));
  EXPECT_THAT(registrationLines(frames.report(), {}), HasSubstr("\"reason\":\"only "));
  EXPECT_EQ(frames.report().frames[2].pose.reason, "") << "it is good";
}

TEST(RegisteredFrames, ComposesWithAMapSoThatGeometryIsResampledOnce) {
  Planted source({waves({}), waves({0.9, 0.6})});
  Progress progress;
  RegisteredFrames frames(source, {}, identityMap({30, 20, 64, 48}), progress);
  const std::vector<ttf::SourceFrame> all = allOf(frames);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].linear.size(), (SizePx{64, 48}));
  EXPECT_NEAR(all[0].linear.at(5, 7, 1), waves({}).at(35, 27, 1), 1e-5);
  EXPECT_LT(largestDifference(all[0].linear, all[1].linear, 0), 0.006);
}

TEST(RegisteredFrames, HoldsOnToFiducialsAlone) {
  // The left 60 px creep to the left, too slowly for a bump; what is right of them moves by half a
  // pixel a frame.
  std::deque<Image<float>> frames;
  for (int k = 0; k < 3; ++k) {
    Image<float> frame = waves({0.5 * k, 0});
    const Image<float> other = waves({-0.4 * k, 0}, 3);
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 60; ++x)
        for (int c = 0; c < 3; ++c) frame.at(x, y, c) = other.at(x, y, c);
    frames.push_back(std::move(frame));
  }
  Planted source(std::move(frames));
  RegistrationRequest request;
  request.fiducials = {{64, 0, 64, 96}};
  Progress progress;
  RegisteredFrames registered(source, request, std::nullopt, progress);
  allOf(registered);
  ASSERT_EQ(registered.report().frames.size(), 3u);
  for (const RegisteredFrame& frame : registered.report().frames)
    EXPECT_NEAR(frame.pose.frame_from_reference[2], 0.05 * frame.time_s, 0.1);
}

TEST(RegisteredFrames, WritesALineAFrame) {
  Planted source({waves({}), waves({0.4, -0.3})});
  Progress progress;
  RegisteredFrames frames(source, {}, std::nullopt, progress);
  allOf(frames);
  const std::string lines = registrationLines(frames.report(), {});
  EXPECT_EQ(std::ranges::count(lines, '\n'), 3);
  EXPECT_THAT(lines, HasSubstr("\"schema\":\"patina.registration/1\""));
  EXPECT_THAT(lines, HasSubstr("\"m02\":"));
  EXPECT_THAT(lines, HasSubstr("\"verdict\":\"good\""));
}

TEST(RegisteredFrames, RefusesFiducialsThatAreNotThere) {
  Progress progress;
  RegistrationRequest request;
  request.fiducials = {{100, 0, 64, 96}};
  Planted source({waves({})});
  RegisteredFrames outside(source, request, std::nullopt, progress);
  EXPECT_THROW(outside.next(), calibration::CalibrationError);
  request.fiducials = {};
  request.markers = true;
  Planted again({waves({})});
  RegisteredFrames unmarked(again, request, std::nullopt, progress);
  EXPECT_THROW(unmarked.next(), calibration::CalibrationError);
}

}  // namespace
}  // namespace patina::workflow
