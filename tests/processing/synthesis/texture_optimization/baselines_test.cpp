// SPDX-License-Identifier: GPL-3.0-or-later
// What was done before, as counter-examples: voting on the factors of STAF (Meister et al. 2021,
// figure 6) and transfer by scaling them, texel on texel (Gu et al. 2006; figure 8).
#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"
#include "processing/stbrdf/polynomial_fit.h"
#include "processing/stbrdf/staf.h"
#include "processing/synthesis/texture_optimization/transfer.h"
#include "tests/processing/stbrdf/staf_samples.h"

namespace patina::texture_optimization {
namespace {

constexpr int kSide = 10, kVotes = 25;

int voter(int group, int k) {
  return static_cast<int>(uniformBelow(
      hashSeed(static_cast<std::uint64_t>(group), static_cast<std::uint64_t>(k)), kSide * kSide));
}

// A map whose texel g holds the mean of `kVotes` texels of `map`.
Image<float> voted(const Image<float>& map) {
  Image<float> out(kSide, kSide, 1);
  for (int g = 0; g < kSide * kSide; ++g) {
    double sum = 0;
    for (int k = 0; k < kVotes; ++k) sum += map.texels()[static_cast<std::size_t>(voter(g, k))];
    out.texels()[static_cast<std::size_t>(g)] = static_cast<float>(sum / kVotes);
  }
  return out;
}

TEST(VotingOnFactors, IsNoMeanOfTheCurvesAndVotingOnPolynomialsIs) {
  const stbrdf::TimeSamples samples = stbrdf::singleProcess("Diffuse", 1, kSide, 13);
  Progress progress;
  const stbrdf::StafFit staf = stbrdf::fitStaf(samples, {}, progress);
  ASSERT_LT(staf.rms[0], 0.01);  // it is not the factors that are wrong
  const stbrdf::TimeMap poly =
      stbrdf::fitMap(samples, {.degree = 6, .weights = {}, .bounded = false}, progress).map;
  stbrdf::StafMap factors = staf.map;
  stbrdf::StafChannel& channel = factors.channels[0];
  for (auto part : {&stbrdf::StafChannel::a, &stbrdf::StafChannel::d, &stbrdf::StafChannel::rate,
                    &stbrdf::StafChannel::offset})
    channel.*part = voted(channel.*part);
  stbrdf::TimeMap coefficients = poly;
  for (Image<float>& c : coefficients.coefficients) c = voted(c);

  double staf_off = 0, poly_off = 0;
  int count = 0;
  for (double t = 0; t <= 1; t += 0.125) {
    const Image<float> of_factors = evaluate(factors, t, stbrdf::Clamp::kNone),
                       mean_of_staf = voted(evaluate(staf.map, t, stbrdf::Clamp::kNone)),
                       of_poly =
                           evaluate(coefficients, stbrdf::basisOf(6), t, stbrdf::Clamp::kNone),
                       mean_of_poly =
                           voted(evaluate(poly, stbrdf::basisOf(6), t, stbrdf::Clamp::kNone));
    for (std::size_t i = 0; i < of_poly.texels().size(); ++i, ++count) {
      staf_off += std::pow(of_factors.texels()[i] - mean_of_staf.texels()[i], 2);
      poly_off += std::pow(of_poly.texels()[i] - mean_of_poly.texels()[i], 2);
    }
  }
  EXPECT_GT(std::sqrt(staf_off / count), 0.01);
  EXPECT_LT(std::sqrt(poly_off / count), 1e-5);
}

constexpr int kSample = 40, kPicture = 64;

// A material that is plain at first, a little darker here and there; a waffle burns into what is.
stbrdf::StbrdfSet waffle() {
  stbrdf::StbrdfSet set{.degree = 1, .maps = {}, .facts = {}};
  for (const auto& [name, channels] :
       {std::pair{"Diffuse", 3}, {"Specular", 1}, {"Roughness", 1}}) {
    stbrdf::TimeMap map{.name = name, .coefficients = {}};
    map.coefficients.assign(2, Image<float>(kSample, kSample, channels));
    for (int y = 0; y < kSample; ++y)
      for (int x = 0; x < kSample; ++x) {
        const bool ridge = x % 10 < 3 || y % 10 < 3;
        const double grain = uniform(
            hashSeed(static_cast<std::uint64_t>(x / 2), static_cast<std::uint64_t>(y / 2), 3));
        for (int c = 0; c < channels; ++c) {
          map.coefficients[0].at(x, y, c) = static_cast<float>(0.6 + 0.08 * grain - 0.1 * ridge);
          map.coefficients[1].at(x, y, c) = ridge ? -0.35f : -0.05f;
        }
      }
    set.maps.push_back(std::move(map));
  }
  return set;
}

// Slanted stripes.
Image<float> stripes() {
  Image<float> out(kPicture, kPicture, 3);
  for (int y = 0; y < kPicture; ++y)
    for (int x = 0; x < kPicture; ++x)
      for (int c = 0; c < 3; ++c)
        out.at(x, y, c) = static_cast<float>(0.55 + 0.15 * std::sin(0.45 * x + 0.3 * y));
  return out;
}

double correlation(const Image<float>& a, const Image<float>& b) {
  double ab = 0, aa = 0, bb = 0, ma = 0, mb = 0;
  const auto n = static_cast<double>(a.texels().size());
  for (std::size_t i = 0; i < a.texels().size(); ++i) ma += a.texels()[i], mb += b.texels()[i];
  for (std::size_t i = 0; i < a.texels().size(); ++i) {
    const double u = a.texels()[i] - ma / n, v = b.texels()[i] - mb / n;
    ab += u * v, aa += u * u, bb += v * v;
  }
  return ab / std::sqrt(aa * bb);
}

TEST(TransferByScaling, LaysTheSamplesPatternOverThePictureAndOursDoesNot) {
  const stbrdf::StbrdfSet sample = waffle();
  const Image<float> picture = stripes();
  const auto late = [](const stbrdf::StbrdfSet& set) {
    return evaluate(*set.find("Diffuse"), set.basis, 1, stbrdf::Clamp::kNone);
  };
  const Image<float> early =
                         evaluate(*sample.find("Diffuse"), sample.basis, 0, stbrdf::Clamp::kNone),
                     burnt = late(sample);
  Image<float> scaled(kPicture, kPicture, 3), pattern(kPicture, kPicture, 3);
  for (int y = 0; y < kPicture; ++y)
    for (int x = 0; x < kPicture; ++x)
      for (int c = 0; c < 3; ++c) {
        pattern.at(x, y, c) = burnt.at(x % kSample, y % kSample, c);
        scaled.at(x, y, c) =
            picture.at(x, y, c) / early.at(x % kSample, y % kSample, c) * pattern.at(x, y, c);
      }
  Progress progress;
  TransferOptions options;
  options.enlarge.optimize.rounds = 4;
  const Image<float> ours =
      late(transfer(sample, picture.view(), options, {}, progress).larger.set);
  EXPECT_GT(correlation(scaled, pattern), 0.7);
  EXPECT_LT(std::abs(correlation(ours, pattern)), 0.3);
  EXPECT_GT(correlation(ours, picture), 0.8);
  EXPECT_LT(correlation(scaled, picture), 0.6);
}

}  // namespace
}  // namespace patina::texture_optimization
