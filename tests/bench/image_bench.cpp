// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "processing/image/dng_file.h"
#include "processing/image/encoding.h"
#include "processing/image/film_file.h"
#include "processing/image/random.h"
#include "tests/support/temp_folder.h"

namespace patina {
namespace {

// Smooth shapes with a little noise, as a camera gives them.
Image<std::uint8_t> photograph(int width, int height, int seed) {
  Image<std::uint8_t> out(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c)
        out.at(x, y, c) = static_cast<std::uint8_t>(60 + 100 * x / width +
                                                    30 * ((x / 24 + y / 40 + seed / 8) % 2) +
                                                    uniformBelow(hashSeed(seed, x, y, c), 5));
  return out;
}

void BM_JpegThereAndBack(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0)), height = width * 3 / 4;
  const auto picture = photograph(width, height, 1);
  for (auto _ : state) benchmark::DoNotOptimize(decodePicture(encodeJpeg(picture.view())));
  state.SetItemsProcessed(state.iterations() * width * height);
}
BENCHMARK(BM_JpegThereAndBack)->Arg(64)->Arg(1024)->Unit(benchmark::kMicrosecond);

void BM_DngThereAndBack(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0)), height = width * 3 / 4;
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(width, height, 1);
  for (std::size_t i = 0; i < raw.samples.texels().size(); ++i)
    raw.samples.texels()[i] = static_cast<std::uint16_t>(hashSeed(i) % 4096);
  raw.white_level = 4095;
  for (auto _ : state) benchmark::DoNotOptimize(decodePicture(encodeDng(raw)));
  state.SetItemsProcessed(state.iterations() * width * height);
}
BENCHMARK(BM_DngThereAndBack)->Arg(64)->Arg(1024)->Unit(benchmark::kMicrosecond);

void BM_EncodeSrgb8(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  Image<float> linear(side, side, 3);
  for (std::size_t i = 0; i < linear.texels().size(); ++i)
    linear.texels()[i] = static_cast<float>(uniform(hashSeed(i)));
  for (auto _ : state) benchmark::DoNotOptimize(encodeSrgb8(std::as_const(linear).view()));
  state.SetItemsProcessed(state.iterations() * side * side);
}
BENCHMARK(BM_EncodeSrgb8)->Arg(1024)->UseRealTime()->Unit(benchmark::kMillisecond);

// Items are frames.
void BM_FilmWriter(benchmark::State& state) {
  const int side = static_cast<int>(state.range(0));
  std::vector<Image<std::uint8_t>> frames;
  for (int i = 0; i < 16; ++i) frames.push_back(photograph(side, side, i));
  const auto folder = testing::TempFolder::inMemory();
  for (auto _ : state) {
    FilmWriter film(folder / "film.mp4", {side, side}, {});
    for (int i = 0; i < 96; ++i) film.add(std::as_const(frames[i % 16]).view());
    film.close();
  }
  state.SetItemsProcessed(state.iterations() * 96);
}
BENCHMARK(BM_FilmWriter)->Arg(1024)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace patina
