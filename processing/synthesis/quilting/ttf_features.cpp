// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/ttf_features.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "processing/image/encoding.h"

namespace patina::quilting {
namespace {

constexpr int kTileTexels = 128;               // a TTF's chunk
constexpr std::int64_t kTileBytes = 96 << 20;  // of all frames of a tile
constexpr double kContrastFloor = 0.2;         // of the strongest frame's

// One over each frame's contrast: a seam is seen against what else the frame shows, so a faint
// early frame counts as much as a strong late one. Frames without contrast are held down (noise).
std::vector<float> frameWeights(const QuiltingSource& source, const std::vector<float>& display) {
  std::vector<double> contrast;
  for (int t = 0; t < source.info().frames; ++t) {
    const Image<std::uint16_t> frame = source.frame(t);
    const int channels = frame.channels();
    double variance = 0;
    for (int c = 0; c < channels; ++c) {
      double sum = 0, squares = 0;
      for (std::size_t i = c; i < frame.texels().size(); i += channels) {
        const double v = display[frame.texels()[i]];
        sum += v;
        squares += v * v;
      }
      const double n = static_cast<double>(frame.texels().size()) / channels;
      variance += std::max(0.0, squares / n - sum / n * sum / n);
    }
    contrast.push_back(std::sqrt(variance));
  }
  const double strongest = *std::max_element(contrast.begin(), contrast.end());
  std::vector<float> weights;
  for (double c : contrast)
    weights.push_back(static_cast<float>(
        strongest > 0 ? (1 + kContrastFloor) * strongest / (c + kContrastFloor * strongest) : 1));
  return weights;
}

// Rows of T, tile by tile as they lie in the file: [frame][channel] of one texel.
class TileRows {
 public:
  TileRows(const QuiltingSource& source)
      : source_(source),
        display_(displayTable(source.info().scale)),
        weights_(frameWeights(source, display_)) {
    const ttf::TtfInfo& info = source.info();
    const std::int64_t row_bytes =
        static_cast<std::int64_t>(info.frames) * kTileTexels * info.channels * 2;
    const int rows =
        static_cast<int>(std::clamp<std::int64_t>(kTileBytes / row_bytes, 1, kTileTexels));
    for (int y = 0; y < info.height; y += rows)
      for (int x = 0; x < info.width; x += kTileTexels)
        tiles_.push_back(
            {x, y, std::min(kTileTexels, info.width - x), std::min(rows, info.height - y)});
    for (const RectPx& tile : tiles_)
      for (int y = tile.y; y < tile.y + tile.height; ++y)
        for (int x = tile.x; x < tile.x + tile.width; ++x) texels_.push_back(y * info.width + x);
  }

  // Row i of T is this texel of the image.
  const std::vector<std::int32_t>& texels() const { return texels_; }

  const std::vector<float>& weights() const { return weights_; }

  void fill(std::int64_t first, std::int64_t count, std::span<float> rows) {
    if (first == 0) next_tile_ = tile_first_ = tile_count_ = 0;
    const std::int64_t n = rows.size() / count;
    for (std::int64_t done = 0; done < count;) {
      if (first + done == tile_first_ + tile_count_) loadTile();
      const std::int64_t offset = first + done - tile_first_;
      const std::int64_t here = std::min(count - done, tile_count_ - offset);
      transpose(offset, here, rows.data() + done * n);
      done += here;
    }
  }

 private:
  void loadTile() {
    const RectPx& tile = tiles_[next_tile_++];
    samples_ = source_.block(tile);
    tile_first_ += tile_count_;
    tile_count_ = static_cast<std::int64_t>(tile.width) * tile.height;
  }

  // samples_ [t][texel][c] to rows [texel][t][c].
  void transpose(std::int64_t first, std::int64_t count, float* rows) const {
    const int frames = source_.info().frames, channels = source_.info().channels;
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, 16), [&](const auto& range) {
      for (int t = 0; t < frames; ++t) {
        const std::uint16_t* in =
            samples_.data() + (t * tile_count_ + first + range.begin()) * channels;
        for (std::int64_t i = range.begin(); i < range.end(); ++i)
          for (int c = 0; c < channels; ++c)
            rows[(i * frames + t) * channels + c] = weights_[t] * display_[*in++];
      }
    });
  }

  const QuiltingSource& source_;
  std::vector<float> display_, weights_;
  std::vector<RectPx> tiles_;
  std::vector<std::int32_t> texels_;
  std::vector<std::uint16_t> samples_;
  std::size_t next_tile_ = 0;
  std::int64_t tile_first_ = 0, tile_count_ = 0;
};

}  // namespace

Image<std::uint16_t> QuiltingSource::frame(int t) const {
  Image<std::uint16_t> frame = input_.frame(t);
  if (low_frequency_)
    low_frequency_->takeOut(t, {0, 0, frame.width(), frame.height()}, &frame.at(0, 0));
  return frame;
}

Image<float> QuiltingSource::linearFrame(int t) const {
  Image<float> frame = input_.linearFrame(t);
  if (low_frequency_)
    low_frequency_->takeOut(t, {0, 0, frame.width(), frame.height()}, &frame.at(0, 0));
  return frame;
}

std::vector<std::uint16_t> QuiltingSource::block(RectPx region) const {
  std::vector<std::uint16_t> samples = input_.block(0, info().frames, region);
  const std::size_t frame = samples.size() / info().frames;
  if (low_frequency_)
    for (int t = 0; t < info().frames; ++t)
      low_frequency_->takeOut(t, region, samples.data() + t * frame);
  return samples;
}

std::vector<float> displayTable(double scale) {
  std::vector<float> table(65536);
  for (int i = 0; i < 65536; ++i)
    table[i] = srgbFromLinear(static_cast<float>(std::min(1.0, i * scale / 65535.0)));
  return table;
}

TtfFeatures ttfFeatures(const QuiltingSource& source, int rank_max,
                        std::optional<double> rank_error, Progress& progress) {
  const ttf::TtfInfo& info = source.info();
  TileRows rows(source);
  const std::int64_t m = static_cast<std::int64_t>(info.width) * info.height;
  const std::int64_t n = static_cast<std::int64_t>(info.frames) * info.channels;
  decomposition::SvdOptions options;
  options.rank = static_cast<int>(std::min<std::int64_t>(rank_max, std::min(m, n)));
  options.rank_error = rank_error.value_or(0);
  options.centre = true;  // distances are the same, and no rank is spent on the mean picture
  decomposition::TemporalSvd svd = decomposition::temporalSvd(
      m, n,
      [&](std::int64_t first, std::int64_t count, std::span<float> out) {
        rows.fill(first, count, out);
      },
      options, progress);
  TtfFeatures result{Image<float>(info.width, info.height, svd.rank), std::move(svd.basis),
                     std::move(svd.mean), rows.weights(), svd.relative_error};
  for (std::int64_t i = 0; i < m; ++i)
    std::copy_n(
        svd.scores.begin() + i * svd.rank, svd.rank,
        result.features.texels().begin() + static_cast<std::int64_t>(rows.texels()[i]) * svd.rank);
  return result;
}

}  // namespace patina::quilting
