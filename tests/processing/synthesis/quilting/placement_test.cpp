// SPDX-License-Identifier: GPL-3.0-or-later
// The search on histories of the twin's specimens: the choice of brute force, each time. The long
// form makes 10,000 placements (PATINA_QUILTING_PLACEMENTS) with blocks of 64 on 256x256.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <cstdlib>
#include <cstring>
#include <limits>
#include <numeric>

#include "processing/decomposition/temporal_svd.h"
#include "processing/image/random.h"
#include "processing/patch/overlap_search.h"
#include "tests/bench/specimen_series.h"

namespace patina::quilting {
namespace {

constexpr int kRank = 15;
constexpr double kTie = 1e-6;

struct Case {
  int side, block, overlap, frames, placements;
};

Case chosenCase() {
  if (const char* placements = std::getenv("PATINA_QUILTING_PLACEMENTS"))
    return {256, 64, 16, 125, std::atoi(placements)};
  return {96, 24, 6, 40, 60};
}

// An L of two places of the source, as it lies under a block that is placed.
struct Placement {
  Image<float> target;
  Image<std::uint8_t> known;
  Placement(const Image<float>& f, const Case& c, int number)
      : target(c.block, c.block, kRank), known(c.block, c.block, 1) {
    const auto draw = [&](int key) {
      return static_cast<int>(uniformBelow(hashSeed(3, number, key), c.side - c.block + 1));
    };
    const int above_x = draw(1), above_y = draw(2), left_x = draw(3), left_y = draw(4);
    for (int y = 0; y < c.block; ++y)
      for (int x = 0; x < c.block; ++x) {
        known.at(x, y) = x < c.overlap || y < c.overlap;
        const float* from =
            y < c.overlap ? &f.at(above_x + x, above_y + y) : &f.at(left_x + x, left_y + y);
        std::copy_n(from, kRank, &target.at(x, y));
      }
  }
  patch::Overlap overlap() const { return {target.view(), known.view()}; }
};

// Every corner, texels in an order that tells far ones early. A sum in float that has passed the
// least by a thousandth is left: it errs by a millionth. All others are summed in double.
class BruteForce {
 public:
  BruteForce(const Image<float>& f, const Case& c) : f_(f), corners_(c.side - c.block + 1) {
    for (int y = 0; y < c.block; ++y)
      for (int x = 0; x < c.block; ++x)
        if (x < c.overlap || y < c.overlap) texels_.push_back({x, y});
    for (std::size_t i = texels_.size() - 1; i > 0; --i)
      std::swap(texels_[i], texels_[uniformBelow(hashSeed(4, i), i + 1)]);
    for (const float* v = f.texels().data(); v != f.texels().data() + f.texels().size(); v += kRank)
      padded_.push_back(padded(v));
    for (const SizePx& at : texels_)
      offset_.push_back(static_cast<std::ptrdiff_t>(at.height) * f.width() + at.width);
  }
  // The first corner, in raster order, of those that cost the least. Of `likely` the cost is looked
  // at first, so that most others are left early; it decides nothing.
  std::pair<int, int> best(const Placement& p, std::pair<int, int> likely) const {
    std::vector<Lanes> target;
    for (const SizePx& at : texels_) target.push_back(padded(&p.target.at(at.width, at.height)));
    std::vector<double> costs(static_cast<std::size_t>(corners_) * corners_,
                              std::numeric_limits<double>::infinity());
    double least = inDouble(p, likely.first, likely.second);
    for (int y = 0; y < corners_; ++y)
      for (int x = 0; x < corners_; ++x) {
        if (isFar(target, x, y, static_cast<float>(1.001 * least))) continue;
        double& cost = costs[static_cast<std::size_t>(y) * corners_ + x];
        cost = inDouble(p, x, y);
        least = std::min(least, cost);
      }
    for (int i = 0; i < corners_ * corners_; ++i)
      if (costs[i] <= least * (1 + kTie)) return {i % corners_, i / corners_};
    return {-1, -1};
  }

 private:
  using Four [[gnu::vector_size(16)]] = float;
  struct Lanes {
    Four v[4];
  };
  static Lanes padded(const float* texel) {
    float values[16] = {};
    std::copy_n(texel, kRank, values);
    Lanes lanes;
    std::memcpy(&lanes, values, sizeof lanes);
    return lanes;
  }
  bool isFar(const std::vector<Lanes>& target, int x, int y, float limit) const {
    const Lanes* corner = padded_.data() + static_cast<std::ptrdiff_t>(y) * f_.width() + x;
    Four a{}, b{}, c{}, d{};
    for (std::size_t i = 0; i < texels_.size(); ++i) {
      const Four* f = corner[offset_[i]].v;
      const Four* t = target[i].v;
      a += (f[0] - t[0]) * (f[0] - t[0]);
      b += (f[1] - t[1]) * (f[1] - t[1]);
      c += (f[2] - t[2]) * (f[2] - t[2]);
      d += (f[3] - t[3]) * (f[3] - t[3]);
      if (i % 32 != 31) continue;
      const Four sum = (a + b) + (c + d);
      if (sum[0] + sum[1] + sum[2] + sum[3] > limit) return true;
    }
    return false;
  }
  double inDouble(const Placement& p, int x, int y) const {
    double sum = 0;
    for (const SizePx& at : texels_)
      for (int k = 0; k < kRank; ++k) {
        const double d = static_cast<double>(f_.at(x + at.width, y + at.height, k)) -
                         p.target.at(at.width, at.height, k);
        sum += d * d;
      }
    return sum;
  }

  const Image<float>& f_;
  int corners_;
  std::vector<SizePx> texels_;
  std::vector<std::ptrdiff_t> offset_;  // of texels_, in a corner of padded_
  std::vector<Lanes> padded_;
};

TEST(Placement, IsThatOfBruteForceOnThreeSpecimens) {
  const Case c = chosenCase();
  for (const char* name : {"grass_growth", "snow_accumulation", "steel_rusting"}) {
    const std::vector<float> series = bench::specimenSeries(name, {c.side, c.side}, c.frames);
    Progress progress;
    Image<float> f(c.side, c.side, kRank);
    f.texels() = decomposition::temporalSvd(std::int64_t{c.side} * c.side, c.frames, series,
                                            {.rank = kRank, .centre = true}, progress)
                     .scores;
    patch::OverlapSearch search(f.view(), {c.block, c.block});
    const BruteForce brute(f, c);
    std::vector<std::pair<int, int>> found(c.placements), wanted(c.placements);
    for (int i = 0; i < c.placements; ++i) {
      const patch::Candidate first =
          search.candidates(Placement(f, c, i).overlap(), {kTie, 0, {}}).front();
      found[i] = {first.x, first.y};
    }
    tbb::parallel_for(0, c.placements,
                      [&](int i) { wanted[i] = brute.best(Placement(f, c, i), found[i]); });
    int same = 0;
    for (int i = 0; i < c.placements; ++i) {
      same += found[i] == wanted[i];
      EXPECT_EQ(found[i], wanted[i]) << name << ", placement " << i;
    }
    std::printf("%s: %d of %d placements as by brute force\n", name, same, c.placements);
  }
}

}  // namespace
}  // namespace patina::quilting
