// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/nearest_field.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

constexpr int kSource = 40, kTarget = 90;

std::size_t indexOf(int x, int y, int width) {
  const int index = y * width + x;
  return static_cast<std::size_t>(index);
}

// Soft blobs: patches that continue one another.
Image<std::int16_t> blobs() {
  Image<std::int16_t> out(kSource, kSource, 8);
  for (int y = 0; y < kSource; ++y)
    for (int x = 0; x < kSource; ++x)
      for (int c = 0; c < 3; ++c)
        out.at(x, y, c) = static_cast<std::int16_t>(
            700.0 / (1 + c) * (std::sin(0.5 * x + c) + std::sin(0.37 * y - 0.2 * x + 2 * c)));
  return out;
}

std::vector<std::int32_t> anywhere(std::uint64_t seed) {
  std::vector<std::int32_t> out;
  for (std::uint64_t i = 0; i < kTarget * kTarget; ++i)
    out.push_back(
        static_cast<std::int32_t>((2 + uniformBelow(hashSeed(seed, i, 1), kSource - 4)) * kSource +
                                  2 + uniformBelow(hashSeed(seed, i, 2), kSource - 4)));
  return out;
}

struct Outcome {
  std::vector<std::int32_t> centres;
  FieldEnergy before, after;
};

Outcome optimised(const FieldOptions& options, int rounds, const FieldLimits& limits = {}) {
  const Image<std::int16_t> source = blobs();
  NearestField field(source.view(), 1000, {kTarget, kTarget}, options, limits);
  field.start(anywhere(7));
  field.vote();
  Outcome out;
  out.before = field.energy();
  for (int round = 0; round < rounds; ++round) {
    for (int pass = 0; pass < 4; ++pass) field.search(4 * round + pass);
    field.vote();
  }
  out.centres = field.centres();
  out.after = field.energy();
  return out;
}

TEST(NearestField, IsTheSameForAnyNumberOfThreads) {
  for (const SearchKind search : {SearchKind::kCoherent, SearchKind::kPatchMatch}) {
    std::vector<std::vector<std::int32_t>> centres;
    for (const int threads : {1, 2, 8}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      centres.push_back(optimised({.search = search, .similar = {}}, 3).centres);
    }
    EXPECT_EQ(centres[0], centres[1]);
    EXPECT_EQ(centres[0], centres[2]);
  }
}

TEST(NearestField, LowersTheEnergyAndKeepsUseEven) {
  for (const SearchKind search : {SearchKind::kCoherent, SearchKind::kPatchMatch}) {
    const Outcome out = optimised({.uniformity = 2, .search = search, .similar = {}}, 6);
    EXPECT_LT(out.after.patch, 0.3 * out.before.patch);
    EXPECT_LT(out.after.occupancy, 2);
  }
}

// The sum over all source patches of their occupancy follows from the field alone: what lanes told
// one another is neither lost nor counted twice.
TEST(NearestField, CountsUsesExactlyAfterManySteps) {
  const Outcome out = optimised({.uniformity = 2, .similar = {}}, 4);
  Occupancy counted({kSource, kSource}, 5);
  for (const std::int32_t centre : out.centres) counted.add(centre);
  double sum = 0;
  for (const std::int32_t centre : out.centres) sum += counted.at(centre);
  const double even = static_cast<double>(kTarget * kTarget) / (kSource * kSource) * 625;
  EXPECT_NEAR(out.after.occupancy, sum / (kTarget * kTarget) / even, 1e-9);
}

// Squared difference of a target patch, as the field `shown` votes it, and a source patch; on all
// of `parts`, over the whole patch.
double distanceOf(const std::vector<std::int32_t>& shown, int x, int y, std::int32_t centre,
                  std::span<const Image<std::int16_t>> parts) {
  const Votes votes{shown, {kTarget, kTarget}, kSource, 2, true, {}};
  double sum = 0;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx)
      for (const Image<std::int16_t>& part : parts)
        for (int c = 0; c < 4; ++c) {
          double mean = 0;
          const auto value = [&](std::int32_t at) {
            return static_cast<double>(part.at(at % kSource, at / kSource, c));
          };
          const int count =
              forEachVote(votes, (x + dx + kTarget) % kTarget, (y + dy + kTarget) % kTarget,
                          [&](std::int32_t at, int, int) { mean += value(at); });
          sum += std::pow(mean / count - value(centre + dy * kSource + dx), 2);
        }
  return sum;
}

// The leading components tell little, others much: a patch that is taken is nearer on all of them.
TEST(NearestField, TakesWhatIsNearerOnAllComponents) {
  std::vector<Image<std::int16_t>> parts(2, Image<std::int16_t>(kSource, kSource, 4));
  for (int y = 0; y < kSource; ++y)
    for (int x = 0; x < kSource; ++x)
      for (int c = 0; c < 2; ++c) {
        parts[0].at(x, y, c) = blobs().at(x, y, c);
        parts[1].at(x, y, c) = static_cast<std::int16_t>(
            uniformBelow(hashSeed(indexOf(x, y, kSource), static_cast<std::uint64_t>(c)), 1500));
      }
  const FurtherComponents further[] = {{.source = parts[1].view()}};
  NearestField field(parts[0].view(), 1000, {kTarget, kTarget},
                     {.uniformity = 0, .similar = {}, .wraps = true}, {.further = further});
  field.start(anywhere(7));
  std::vector<std::int32_t> before = field.centres();
  for (int pass = 0; pass < 2; ++pass) {
    field.vote();
    before = field.centres();
    field.search(pass);
  }
  int changed = 0;
  double gained = 0;
  for (int y = 0; y < kTarget; ++y)
    for (int x = 0; x < kTarget; ++x) {
      const std::size_t at = indexOf(x, y, kTarget);
      if (field.centres()[at] == before[at]) continue;
      const double was = distanceOf(before, x, y, before[at], parts),
                   is = distanceOf(before, x, y, field.centres()[at], parts);
      ++changed;
      gained += (was - is) / was;
      ASSERT_LT(is, was * 1.001) << x << " " << y;  // but for rounded votes
    }
  EXPECT_GT(changed, 500);
  EXPECT_GT(gained / changed, 0.1);
}

// A gain that is next to nothing is not worth a change, which wakes eight neighbours: else a third
// of all patches would change still.
TEST(NearestField, ChangesNothingForNextToNoGain) {
  const Image<std::int16_t> source = blobs();
  NearestField field(source.view(), 1000, {kTarget, kTarget}, {.uniformity = 2, .similar = {}});
  field.start(anywhere(7));
  int changed = 0;
  for (int pass = 0; pass < 24; ++pass) {
    if (pass % 2 == 0) field.vote();
    const std::vector<std::int32_t> before = field.centres();
    field.search(pass);
    changed = 0;
    for (std::size_t i = 0; i < before.size(); ++i) changed += field.centres()[i] != before[i];
  }
  EXPECT_LT(changed, 0.15 * kTarget * kTarget);
}

TEST(NearestField, UsesTheSourceMoreEvenlyTheMoreThatCounts) {
  const Outcome even = optimised({.uniformity = 5, .similar = {}}, 4),
                free = optimised({.uniformity = 0, .similar = {}}, 4);
  EXPECT_GT(free.after.occupancy, 1.2 * even.after.occupancy);
}

TEST(NearestField, ShowsNoPatchThatCoversAMaskedTexel) {
  std::vector<std::uint8_t> usable(kSource * kSource, 1);
  for (int y = 10; y < 20; ++y)
    for (int x = 5; x < 30; ++x) usable[indexOf(x, y, kSource)] = 0;
  for (const SearchKind search : {SearchKind::kCoherent, SearchKind::kPatchMatch})
    for (const std::int32_t centre :
         optimised({.search = search, .similar = {}}, 2, {.usable = usable}).centres)
      for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx)
          ASSERT_NE(usable[static_cast<std::size_t>(centre + dy * kSource + dx)], 0);
  usable.assign(usable.size(), 0);
  EXPECT_THROW(optimised({.similar = {}}, 1, {.usable = usable}), ProcessingError);
}

TEST(NearestField, LeavesKeptPatchesWhereTheyAre) {
  std::vector<std::int32_t> kept(kTarget * kTarget, -1);
  const std::vector<std::int32_t> places = anywhere(3);
  for (std::size_t i = 0; i < kept.size(); i += 7) kept[i] = places[i];
  kept[5] = 0;  // the source's corner is no patch's centre: another patch may lie there
  const std::vector<std::int32_t> end = optimised({.similar = {}}, 2, {.kept = kept}).centres;
  for (std::size_t i = 0; i < kept.size(); ++i) ASSERT_TRUE(kept[i] <= 0 || end[i] == kept[i]);
}

TEST(NearestField, ShowsLabelledPatchesOnlyWhereTheTargetHasThem) {
  Labels labels{.source = {kSource, kSource}, .target = {kTarget, kTarget}, .slack = 4};
  labels.of_source.assign(kSource * kSource, -1);
  labels.of_target.resize(kTarget * kTarget);
  for (int y = 15; y < 22; ++y)
    for (int x = 15; x < 22; ++x) labels.of_source[indexOf(x, y, kSource)] = 1;
  for (int y = 30; y < 60; ++y)
    for (int x = 30; x < 60; ++x) labels.of_target[indexOf(x, y, kTarget)] = {1, 25, 28};
  const Outcome out = optimised({.similar = {}}, 3, {.labels = &labels});
  int shown = 0;
  for (int y = 0; y < kTarget; ++y)
    for (int x = 0; x < kTarget; ++x) {
      const std::int32_t centre = out.centres[indexOf(x, y, kTarget)];
      if (labels.of_source[static_cast<std::size_t>(centre)] < 0) continue;
      ++shown;
      EXPECT_EQ(labels.of_target[indexOf(x, y, kTarget)].label, 1);
      EXPECT_LE(std::abs(x - centre % kSource - 25), 4);
      EXPECT_LE(std::abs(y - centre / kSource - 28), 4);
    }
  EXPECT_GT(shown, 0);
}

// What is left of a join: the mean difference across it over that inside, in the first component.
double joinOf(const Outcome& out) {
  const Image<std::int16_t> source = blobs();
  const auto value = [&](int x, int y) {
    return static_cast<double>(
        source.texels()[8 * static_cast<std::size_t>(out.centres[indexOf(x, y, kTarget)])]);
  };
  double join = 0, inside = 0;
  for (int i = 0; i < kTarget; ++i) {
    join += std::abs(value(kTarget - 1, i) - value(0, i));
    inside += std::abs(value(kTarget / 2, i) - value(kTarget / 2 - 1, i));
  }
  return join / inside;
}

TEST(NearestField, GoesOnAtTheOtherSideWhenItWraps) {
  EXPECT_LT(joinOf(optimised({.similar = {}, .wraps = true}, 6)), 1.5);
  EXPECT_GT(joinOf(optimised({.similar = {}}, 6)), 2);
}

TEST(NearestField, FollowsItsGuide) {
  Image<std::int16_t> source(kSource, kSource, 16);
  for (int y = 0; y < kSource; ++y)
    for (int x = 0; x < kSource; ++x) {
      std::copy_n(&blobs().view().at(x, y), 8, &source.at(x, y));
      source.at(x, y, 8) = static_cast<std::int16_t>(2000 * x / kSource);
    }
  Image<std::int16_t> guide(kTarget, kTarget, 8);
  for (int y = 0; y < kTarget; ++y)
    for (int x = 0; x < kTarget; ++x)
      guide.at(x, y) = static_cast<std::int16_t>(2000 * y / kTarget);
  FieldOptions options{.uniformity = 0.01, .similar = {}};
  NearestField field(source.view(), 1000, {kTarget, kTarget}, options, {.guide = guide.view()});
  field.start(anywhere(7));
  field.vote();
  for (int pass = 0; pass < 12; ++pass) {
    field.search(pass);
    field.vote();
  }
  double off = 0;
  for (int y = 0; y < kTarget; ++y)
    for (int x = 0; x < kTarget; ++x)
      off += std::abs(field.centres()[indexOf(x, y, kTarget)] % kSource -
                      static_cast<double>(y) * kSource / kTarget);
  EXPECT_LT(off / (kTarget * kTarget), 3);
}

// Four components that four zeros follow give the same field as without them.
TEST(NearestField, NeedsNoMoreThanFourComponents) {
  std::vector<std::vector<std::int32_t>> centres;
  for (const int components : {4, 8}) {
    Image<std::int16_t> source(kSource, kSource, components);
    for (int y = 0; y < kSource; ++y)
      for (int x = 0; x < kSource; ++x) std::copy_n(&blobs().view().at(x, y), 4, &source.at(x, y));
    NearestField field(source.view(), 1000, {kTarget, kTarget}, {.similar = {}});
    field.start(anywhere(7));
    for (int pass = 0; pass < 3; ++pass) {
      field.vote();
      field.search(pass);
    }
    centres.push_back(field.centres());
  }
  EXPECT_EQ(centres[0], centres[1]);
}

TEST(NearestField, LeavesWhatIsContinuedAsleep) {
  const Image<std::int16_t> source = blobs();
  std::vector<std::int32_t> copies;
  for (int y = 0; y < kTarget; ++y)
    for (int x = 0; x < kTarget; ++x)
      copies.push_back((2 + y % (kSource - 4)) * kSource + 2 + x % (kSource - 4));
  NearestField field(source.view(), 1000, {kTarget, kTarget}, {.uniformity = 0, .similar = {}});
  field.start(copies);
  field.wakeSeams();
  field.vote();
  field.search(0);
  int at_seams = 0, inside = 0;
  for (int y = 0; y < kTarget; ++y)
    for (int x = 0; x < kTarget; ++x) {
      const std::size_t at = indexOf(x, y, kTarget);
      const int dx = x % (kSource - 4), dy = y % (kSource - 4);
      const bool far = std::min(dx, dy) > 12 && std::max(dx, dy) < kSource - 4 - 12;
      (far ? inside : at_seams) += field.centres()[at] != copies[at];
    }
  EXPECT_GT(at_seams, 100);
  EXPECT_EQ(inside, 0);
}

TEST(FieldOptions, RefusesWhatCannotBe) {
  EXPECT_THROW((FieldOptions{.patch = 4, .similar = {}}.check()), ProcessingError);
  EXPECT_THROW((FieldOptions{.uniformity = -1, .similar = {}}.check()), ProcessingError);
  EXPECT_THROW((FieldOptions{.similar = {.count = 0}}.check()), ProcessingError);
}

}  // namespace
}  // namespace patina::patch
