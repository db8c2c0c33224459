// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "processing/synthesis/quilting/canvas.h"
#include "tests/processing/synthesis/quilting/textures.h"

namespace patina::quilting {
namespace {

constexpr SizePx kBlock{10, 10};

// Of a seam between neighbours, as the header says; sources in the middle, so that both go on.
double seamCosts(ImageView<const float> f, const Quilt& quilt) {
  const auto apart = [&](int ax, int ay, int bx, int by) {
    double sum = 0;
    for (int c = 0; c < f.channels; ++c) sum += std::pow(f.at(ax, ay, c) - f.at(bx, by, c), 2);
    return std::sqrt(sum);
  };
  double sum = 0;
  const auto& map = quilt.source_xy;
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x)
      for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
        if (x + dx >= map.width() || y + dy >= map.height()) continue;
        const int ax = map.at(x, y, 0), ay = map.at(x, y, 1), bx = map.at(x + dx, y + dy, 0),
                  by = map.at(x + dx, y + dy, 1);
        sum += apart(ax, ay, bx - dx, by - dy) + apart(ax + dx, ay + dy, bx, by);
      }
  return sum;
}

struct Laid {
  Canvas canvas;
  std::vector<std::array<int, 4>> blocks;  // x, y, source x, source y
  explicit Laid(const Image<float>& f, std::uint64_t seed)
      : canvas(f.view(), {22, 22}, kBlock, false) {
    canvas.setLiveliness(0);
    for (int y : {0, 6, 12})
      for (int x : {0, 6, 12}) {
        const int number = static_cast<int>(blocks.size());
        const int u = 2 + static_cast<int>(uniformBelow(hashSeed(seed, number, 1), 26)),
                  v = 2 + static_cast<int>(uniformBelow(hashSeed(seed, number, 2), 26));
        canvas.look(x, y, number);
        canvas.paste(u, v);
        blocks.push_back({x, y, u, v});
      }
  }
};

TEST(CanvasExpansion, NeverMakesSeamsDearerAndOftenCheaper) {
  const Image<float> f = waveTexture({40, 40}, 3);
  double before = 0, after = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Laid laid(f, seed);
    double cost = seamCosts(f.view(), laid.canvas.cropped({22, 22}));
    before += cost;
    for (std::size_t i = 0; i < laid.blocks.size(); ++i) {
      const auto& [x, y, u, v] = laid.blocks[i];
      laid.canvas.expand(x, y, static_cast<int>(i), u, v);
      const double now = seamCosts(f.view(), laid.canvas.cropped({22, 22}));
      EXPECT_LE(now, cost * (1 + 1e-6));
      cost = now;
    }
    after += cost;
  }
  EXPECT_LT(after, 0.97 * before);
}

TEST(CanvasExpansion, ChangesNothingWhereACopyGoesOn) {
  const Image<float> f = waveTexture({40, 40}, 2);
  Canvas canvas(f.view(), {16, 10}, kBlock, false);
  canvas.look(0, 0, 0);
  canvas.paste(3, 4);
  canvas.look(6, 0, 1);
  canvas.paste(9, 4);
  const auto shown = canvas.cropped({16, 10}).source_xy.texels();
  canvas.expand(0, 0, 0, 3, 4);
  canvas.expand(6, 0, 1, 9, 4);
  EXPECT_EQ(canvas.cropped({16, 10}).source_xy.texels(), shown);
}

TEST(CanvasExpansion, TakesNothingWhereNothingHasChangedSinceItsLastTurn) {
  const Image<float> f = waveTexture({40, 40}, 3);
  int turns = 0, quiet = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Laid laid(f, seed);
    std::vector<int> last(laid.blocks.size(), -1);
    for (int step = 1; step <= 36; ++step) {
      const auto i = static_cast<std::size_t>(step) % laid.blocks.size();
      const auto& [x, y, u, v] = laid.blocks[i];
      const bool must = last[i] < 0 || laid.canvas.isChangedSince(x, y, last[i]);
      laid.canvas.setStep(step);
      const std::int64_t changed = laid.canvas.expand(x, y, static_cast<int>(i), u, v);
      EXPECT_TRUE(must || changed == 0);
      EXPECT_EQ(laid.canvas.isChangedSince(x, y, step - 1), changed > 0);
      last[i] = step;
      ++turns;
      quiet += !must;
    }
  }
  EXPECT_GT(quiet, 20);
  EXPECT_LT(quiet, turns - 45);
}

TEST(CanvasExpansion, LeavesWhatIsKept) {
  const Image<float> f = waveTexture({40, 40}, 3);
  Canvas canvas(f.view(), {16, 10}, kBlock, false);
  Image<std::uint8_t> mask(16, 10, 1);
  for (int y = 2; y < 9; ++y)
    for (int x = 4; x < 11; ++x) mask.at(x, y) = 1;
  canvas.keep(std::as_const(mask).view(), 1, 3, 0);
  canvas.look(0, 0, 1);
  canvas.paste(20, 20);
  canvas.look(6, 0, 2);
  canvas.paste(9, 25);
  canvas.expand(0, 0, 1, 20, 20);
  canvas.expand(6, 0, 2, 9, 25);
  const Quilt quilt = canvas.cropped({16, 10});
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 16; ++x) {
      EXPECT_GE(quilt.source_xy.at(x, y, 0), 0);
      if (mask.at(x, y) == 0) continue;
      EXPECT_EQ(quilt.source_xy.at(x, y, 0), 1 + x);
      EXPECT_EQ(quilt.source_xy.at(x, y, 1), 3 + y);
    }
}

}  // namespace
}  // namespace patina::quilting
