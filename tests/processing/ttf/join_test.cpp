// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/join.h"

#include <gtest/gtest.h>

#include "processing/image/failure.h"
#include "processing/image/random.h"
#include "tests/support/temp_folder.h"

namespace patina::ttf {
namespace {

using patina::testing::TempFolder;

struct Planted {
  SizePx size{9, 7};
  SampleType type = SampleType::kU16;
  double scale = 1, frame_s = 60, mm_per_texel = 0;
  int frames = 5;
  std::uint64_t seed = 1;
};

TtfReader planted(const std::filesystem::path& path, const Planted& p) {
  TtfInfo info;
  info.width = p.size.width;
  info.height = p.size.height;
  info.type = p.type;
  info.scale = p.scale;
  info.mm_per_texel = p.mm_per_texel;
  TtfWriter writer(path, info);
  for (int t = 0; t < p.frames; ++t) {
    Image<float> frame(p.size.width, p.size.height, 3);
    for (std::size_t i = 0; i < frame.texels().size(); ++i)
      frame.texels()[i] =
          static_cast<float>(p.scale * uniform(hashSeed(p.seed, static_cast<std::uint64_t>(t), i)));
    writer.add(std::as_const(frame).view(), p.frame_s * t, Sha256{});
  }
  writer.close();
  return TtfReader(path);
}

class Pair {
 public:
  Pair(const Planted& a, const Planted& b) {
    inputs_.push_back(planted(folder_ / "a.h5", a));
    inputs_.push_back(planted(folder_ / "b.h5", b));
  }
  std::vector<RectPx> join() {
    Progress progress;
    return joinTtfs(inputs_, folder_ / "joined.h5", progress);
  }
  TtfReader joined() const { return TtfReader(folder_ / "joined.h5"); }
  const TtfReader& input(std::size_t i) const { return inputs_[i]; }
  std::string refusal() {
    try {
      join();
    } catch (const ProcessingError& e) {
      EXPECT_FALSE(std::filesystem::exists(folder_ / "joined.h5"));
      return e.what();
    }
    return "";
  }

 private:
  TempFolder folder_ = TempFolder::inMemory();
  std::vector<TtfReader> inputs_;
};

TEST(JoinTtfs, LaysEveryInputWholeAndAsStoredSideBySide) {
  for (const SampleType type : {SampleType::kU8, SampleType::kU16}) {
    Pair pair({.type = type, .scale = 0.5},
              {.size = {4, 11}, .type = type, .scale = 0.5, .seed = 2});
    const std::vector<RectPx> places = pair.join();
    const TtfReader joined = pair.joined();
    EXPECT_EQ(joined.info().type, type);
    ASSERT_EQ(places.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_EQ(joined.block(0, 5, places[i]),
                pair.input(i).block(0, 5, {0, 0, places[i].width, places[i].height}));
  }
}

TEST(JoinTtfs, RepeatsTheOutermostTexelsInTheGaps) {
  Pair pair({}, {.size = {4, 11}, .seed = 2});
  pair.join();
  const Image<std::uint16_t> frame = pair.joined().frame(3);
  ASSERT_EQ(frame.size(), (SizePx{9 + 2 + 4, 11}));
  EXPECT_EQ(frame.at(9, 5, 1), pair.input(0).frame(3).at(8, 5, 1));
  EXPECT_EQ(frame.at(10, 5, 1), pair.input(1).frame(3).at(0, 5, 1));
  EXPECT_EQ(frame.at(2, 10, 1), pair.input(0).frame(3).at(2, 6, 1));
}

TEST(JoinTtfs, TellsInputsOfOtherScalesInTheirOwnLight) {
  Pair pair({.scale = 0.5}, {.scale = 2, .seed = 2});
  const std::vector<RectPx> places = pair.join();
  const Image<float> frame = pair.joined().linearFrame(2);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_NEAR(frame.at(places[i].x + 3, 4, 0), pair.input(i).linearFrame(2).at(3, 4, 0),
                2.0 / 65535);
}

TEST(JoinTtfs, RefusesWhatDoesNotAgreeWithTheFirstByItsNumber) {
  EXPECT_NE(Pair({}, {.frames = 6}).refusal().find("input 2 has 6 frames"), std::string::npos);
  EXPECT_NE(Pair({}, {.frame_s = 61}).refusal().find("frame 1 at 61"), std::string::npos);
  EXPECT_NE(
      Pair({.mm_per_texel = 0.1}, {.mm_per_texel = 0.2}).refusal().find("0.200000 mm per texel"),
      std::string::npos);
}

}  // namespace
}  // namespace patina::ttf
