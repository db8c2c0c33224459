// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/optimize.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "tests/processing/synthesis/texture_optimization/samples.h"

namespace patina::texture_optimization {
namespace {

Image<float> features() { return blobs(48).maps[0].coefficients[0]; }

OptimizeOptions shortly(SizePx size) {
  OptimizeOptions options;
  options.size = size;
  options.rounds = 4;
  return options;
}

TEST(Optimize, ShowsPatchesOfTheSourceThatFitTogether) {
  Progress progress;
  const Image<float> sample = features();
  const OptimizedField field = optimize(sample.view(), shortly({100, 80}), {}, progress);
  EXPECT_EQ(field.levels, 1);  // laid out on the next
  ASSERT_EQ(field.centres.size(), 8000u);
  for (const std::int32_t centre : field.centres) {
    ASSERT_TRUE(centre % 48 >= 2 && centre % 48 < 46);
    ASSERT_TRUE(centre / 48 >= 2 && centre / 48 < 46);
  }
  // A patch picked blindly differs by 25 * 3 * 2 * 0.058 on average.
  EXPECT_LT(field.energy.patch, 0.5);
  EXPECT_LT(field.energy.occupancy, 1.6);
}

// Twenty channels that have nothing to do with one another: no few components tell them all.
TEST(Optimize, CountsTheDistanceOfAllChannels) {
  Progress progress;
  Image<float> sample(40, 40, 20);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x)
      for (int c = 0; c < 20; ++c)
        sample.at(x, y, c) = static_cast<float>(std::sin(0.15 * (c + 3) * x + c) +
                                                std::cos(0.1 * (c + 4) * y - 0.2 * x));
  OptimizeOptions options = shortly({64, 56});
  options.field.wraps = true;
  OptimizedField field = optimize(sample.view(), options, {}, progress);
  field.gain = {};
  const Image<float> means = shown(sample.view(), field);
  double sum = 0;
  for (int y = 0; y < 56; ++y)
    for (int x = 0; x < 64; ++x) {
      const std::int32_t centre = field.votes().centres[field.votes().indexOf(x, y)];
      for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx)
          for (int c = 0; c < 20; ++c)
            sum += std::pow(means.at((x + dx + 64) % 64, (y + dy + 56) % 56, c) -
                                sample.at(centre % 40 + dx, centre / 40 + dy, c),
                            2);
    }
  EXPECT_NEAR(field.energy.patch, sum / (64 * 56), 0.01 * field.energy.patch);
}

TEST(Optimize, IsAlmostAsGoodWhereQuick) {
  Progress progress;
  const Image<float> sample = features();
  OptimizeOptions options = shortly({100, 80});
  options.rounds = 8;
  const OptimizedField full = optimize(sample.view(), options, {}, progress);
  options.effort = Effort::kQuick;
  const OptimizedField quick = optimize(sample.view(), options, {}, progress);
  EXPECT_NE(quick.centres, full.centres);
  const auto energy = [](const OptimizedField& f) {
    return f.energy.patch + 0.075 * f.energy.occupancy;
  };
  EXPECT_LT(energy(quick), 1.25 * energy(full));
}

TEST(Optimize, IsTheSameForAnyNumberOfThreadsAndAnotherForAnotherSeed) {
  Progress progress;
  const Image<float> sample = features();
  std::vector<std::vector<std::int32_t>> centres;
  for (const int threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    centres.push_back(optimize(sample.view(), shortly({90, 70}), {}, progress).centres);
  }
  EXPECT_EQ(centres[0], centres[1]);
  EXPECT_EQ(centres[0], centres[2]);
  OptimizeOptions other = shortly({90, 70});
  other.field.seed = 2;
  EXPECT_NE(optimize(sample.view(), other, {}, progress).centres, centres[0]);
}

TEST(Optimize, ShowsNothingOfAMaskedTexelAndKeepsWhatIsKept) {
  Progress progress;
  const Image<float> sample = features();
  Constraints constraints;
  constraints.usable.assign(48 * 48, 1);
  for (std::size_t y = 5; y < 16; ++y)
    for (std::size_t x = 20; x < 40; ++x) constraints.usable[y * 48 + x] = 0;
  constraints.kept.assign(100 * 80, -1);
  for (std::size_t y = 0; y < 30; ++y)
    for (std::size_t x = 0; x < 40; ++x)
      constraints.kept[(y + 20) * 100 + x + 30] = static_cast<std::int32_t>((y + 17) * 48 + x);
  const OptimizedField field = optimize(sample.view(), shortly({100, 80}), constraints, progress);
  // Each texel tells where it is from.
  Image<float> place(48, 48, 1);
  for (std::size_t i = 0; i < place.texels().size(); ++i)
    place.texels()[i] = constraints.usable[i] != 0 ? 1.0f : 1000.0f;
  const Image<float> out = shown(place.view(), field);
  for (const float v : out.texels()) ASSERT_EQ(v, 1.0f);
  const Image<float> kept = shown(sample.view(), field);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(kept.at(x + 30, y + 20, c), sample.at(x, y + 17, c)) << x << " " << y;
}

TEST(Optimize, FollowsAGuideTheMoreThatWeighs) {
  Progress progress;
  const Image<float> sample = features();
  const auto correlation = [&](float weight) {
    Constraints constraints;
    constraints.sample_guide = Image<float>(48, 48, 1);
    constraints.result_guide = Image<float>(96, 96, 1);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 48; ++x) constraints.sample_guide.at(x, y) = weight * sample.at(x, y, 0);
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x)
        constraints.result_guide.at(x, y) =
            weight * (std::hypot(x - 48, y - 48) < 30 ? 0.9f : 0.1f);
    OptimizeOptions options = shortly({96, 96});
    options.field.uniformity = 0.01;
    const OptimizedField field = optimize(sample.view(), options, constraints, progress);
    double sum = 0, sum_a = 0, sum_b = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < field.centres.size(); ++i) {
      const double a = sample.texels()[3 * static_cast<std::size_t>(field.centres[i])],
                   b = constraints.result_guide.texels()[i] / weight;
      sum += a * b, sum_a += a, sum_b += b, aa += a * a, bb += b * b;
    }
    const auto n = static_cast<double>(field.centres.size());
    return (sum / n - sum_a / n * sum_b / n) /
           std::sqrt((aa / n - sum_a / n * sum_a / n) * (bb / n - sum_b / n * sum_b / n));
  };
  EXPECT_GT(correlation(10), 0.9);
  EXPECT_LT(correlation(0.01f), 0.5);
}

TEST(Optimize, RefusesWhatCannotBe) {
  Progress progress;
  const auto exitOf = [&](const Image<float>& sample, const OptimizeOptions& options) {
    try {
      optimize(sample.view(), options, {}, progress);
    } catch (const ProcessingError& e) {
      return e.exit();
    }
    return Exit::kOk;
  };
  EXPECT_EQ(exitOf(Image<float>(4, 40, 1), shortly({50, 50})), Exit::kUsage);
  EXPECT_EQ(exitOf(features(), shortly({50, 3})), Exit::kUsage);
  OptimizeOptions none = shortly({50, 50});
  none.rounds = 0;
  EXPECT_EQ(exitOf(features(), none), Exit::kUsage);
  Image<float> broken = features();
  broken.at(3, 3) = NAN;
  EXPECT_EQ(exitOf(broken, shortly({50, 50})), Exit::kBadData);
  EXPECT_EQ(exitOf(Image<float>(20, 20, 2, 0.5f), shortly({50, 50})), Exit::kOk);
  OptimizeOptions small = shortly({50, 50});
  small.coarsest_px = 5;
  EXPECT_EQ(exitOf(features(), small), Exit::kUsage);
}

TEST(Optimize, RefusesConstraintsOfOtherSizes) {
  Progress progress;
  const auto refused = [&](const Constraints& constraints) {
    EXPECT_THROW(optimize(features().view(), shortly({50, 50}), constraints, progress),
                 ProcessingError);
  };
  Constraints mask, whole_mask, kept, guide, channels;
  mask.usable.assign(7, 1);
  refused(mask);
  whole_mask.usable.assign(48 * 48, 0);
  refused(whole_mask);
  kept.kept.assign(7, -1);
  refused(kept);
  guide.sample_guide = Image<float>(48, 47, 1);
  guide.result_guide = Image<float>(50, 50, 1);
  refused(guide);
  channels.sample_guide = Image<float>(48, 48, 25);
  channels.result_guide = Image<float>(50, 50, 25);
  refused(channels);
}

}  // namespace
}  // namespace patina::texture_optimization
