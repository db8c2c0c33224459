// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/ttf_features.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <utility>

#include "processing/synthesis/quilting/displayed_rows.h"

namespace patina::quilting {
namespace {

constexpr int kTileTexels = 128;                // a TTF's chunk
constexpr int kRowsApart = 8;                   // that come side by side
constexpr std::int64_t kTileBytes = 128 << 20;  // of all frames of a tile
constexpr double kContrastFloor = 0.2;          // of the strongest frame's
constexpr double kCertain = 1e-3;  // of singular values: what is beyond tells no blocks apart

// One over each frame's contrast: a seam is seen against what else the frame shows, so a faint
// early frame counts as much as a strong late one. Frames without contrast are held down (noise).
// `variance` [frames][channels]; a weight a frame.
std::vector<float> frameWeights(std::span<const double> variance, int channels) {
  std::vector<double> contrast(variance.size() / channels);
  for (std::size_t i = 0; i < variance.size(); ++i) contrast[i / channels] += variance[i];
  for (double& c : contrast) c = std::sqrt(c);
  const double strongest = *std::max_element(contrast.begin(), contrast.end());
  std::vector<float> weights;
  for (double c : contrast)
    weights.push_back(static_cast<float>(
        strongest > 0 ? (1 + kContrastFloor) * strongest / (c + kContrastFloor * strongest) : 1));
  return weights;
}

// T, tile by tile as the texels lie in the file; a row of a block is a channel of a frame. While a
// tile is worked on, a thread of its own reads the next.
class Tiles {
 public:
  explicit Tiles(const QuiltingSource& source)
      : source_(source), displayed_(source.info().scale, source.isCoded()) {
    const ttf::TtfInfo& info = source.info();
    const std::int64_t row_bytes = static_cast<std::int64_t>(info.frames) * kTileTexels *
                                   info.channels * (source.isCoded() ? 1 : 2);
    const int rows =
        static_cast<int>(std::clamp<std::int64_t>(kTileBytes / row_bytes, 1, kTileTexels));
    for (int y = 0; y < info.height; y += rows)
      for (int x = 0; x < info.width; x += kTileTexels)
        tiles_.push_back(
            {x, y, std::min(kTileTexels, info.width - x), std::min(rows, info.height - y)});
    for (const RectPx& tile : tiles_)
      for (int y : rowsOf(tile))
        for (int x = 0; x < tile.width; ++x)
          texels_.push_back((tile.y + y) * info.width + tile.x + x);
  }

  // Texel i of T is this texel of the image.
  const std::vector<std::int32_t>& texels() const { return texels_; }

  // Are values steps of kCodeStep? Then they can be had as codes.
  bool areSteps() const { return source_.isCoded() && source_.info().scale == 1; }

  // Values, or codes.
  template <class V>
  void fill(std::int64_t first, std::int64_t count, std::span<V> block) {
    if (first == 0) {
      if (next_.valid()) next_.get();
      next_tile_ = tile_first_ = tile_count_ = 0;
    }
    for (std::int64_t done = 0; done < count;) {
      if (first + done == tile_first_ + tile_count_) loadTile();
      const std::int64_t offset = first + done - tile_first_;
      const std::int64_t here = std::min(count - done, tile_count_ - offset);
      spread(offset, here, block.data() + done, count);
      done += here;
    }
  }

 private:
  struct Samples {
    std::vector<std::uint16_t> linear;
    std::vector<std::uint8_t> codes;  // in its place, where the source is coded
  };

  void read(const RectPx& tile, Samples& samples) const {
    if (source_.isCoded())
      source_.codedBlock(tile, samples.codes);
    else
      samples.linear = source_.block(tile);
  }

  void loadTile() {
    const RectPx& tile = tiles_[next_tile_++];
    if (next_.valid()) {
      next_.get();
      std::swap(samples_, coming_);
    } else {
      read(tile, samples_);
    }
    rows_ = rowsOf(tile);
    tile_width_ = tile.width;
    tile_first_ += tile_count_;
    tile_count_ = static_cast<std::int64_t>(tile.width) * tile.height;
    if (next_tile_ < tiles_.size())
      next_ = std::async(std::launch::async,
                         [this, &next = tiles_[next_tile_]] { read(next, coming_); });
  }

  void spread(std::int64_t first, std::int64_t count, std::uint8_t* block,
              std::int64_t stride) const {
    spread(samples_.codes, first, count, block, stride, spreadCodes);
  }
  void spread(std::int64_t first, std::int64_t count, float* block, std::int64_t stride) const {
    const auto spreadRow = [&](const auto* in, std::int64_t here, int channels, float* out,
                               std::int64_t apart) {
      displayed_.spread(in, here, channels, out, apart);
    };
    if (source_.isCoded())
      spread(samples_.codes, first, count, block, stride, spreadRow);
    else
      spread(samples_.linear, first, count, block, stride, spreadRow);
  }
  // Rows of a tile, far ones side by side: what is learned from the first texels, which may be
  // few, is then of the whole tile.
  static std::vector<int> rowsOf(const RectPx& tile) {
    std::vector<int> rows;
    for (int first = 0; first < kRowsApart; ++first)
      for (int y = first; y < tile.height; y += kRowsApart) rows.push_back(y);
    return rows;
  }

  // Samples [t][y][x][c] to rows [t][c][texel].
  template <class T, class V>
  void spread(const std::vector<T>& samples, std::int64_t first, std::int64_t count, V* block,
              std::int64_t stride, const auto& spreadRow) const {
    const int channels = source_.info().channels;
    tbb::parallel_for(std::int64_t{0}, std::int64_t{source_.info().frames}, [&](std::int64_t t) {
      for (std::int64_t done = 0; done < count;) {
        const std::int64_t y = (first + done) / tile_width_, x = (first + done) % tile_width_,
                           here = std::min(count - done, tile_width_ - x);
        spreadRow(samples.data() + (t * tile_count_ + rows_[y] * tile_width_ + x) * channels, here,
                  channels, block + t * channels * stride + done, stride);
        done += here;
      }
    });
  }

  const QuiltingSource& source_;
  DisplayedRows displayed_;
  std::vector<RectPx> tiles_;
  std::vector<std::int32_t> texels_;
  Samples samples_, coming_;
  std::size_t next_tile_ = 0;
  std::vector<int> rows_;  // of the tile, in the order of its texels
  std::int64_t tile_first_ = 0, tile_count_ = 0, tile_width_ = 0;
  std::future<void> next_;  // fills coming_; last, so that it ends before what it fills
};

// Texel i of the scores is texel `texels[i]` of the image; components go from channel `at` on.
void takeScores(const decomposition::TemporalSvd& svd, const std::vector<std::int32_t>& texels,
                int at, Image<float>& features) {
  const auto rank = static_cast<std::size_t>(svd.rank);
  for (std::size_t i = 0; i < texels.size(); ++i)
    std::copy_n(&svd.scores[i * rank], rank,
                &features.texels()[static_cast<std::size_t>(texels[i]) *
                                       static_cast<std::size_t>(features.channels()) +
                                   static_cast<std::size_t>(at)]);
}

// Of each column of T over all texels.
std::vector<double> varianceOfColumns(Tiles& tiles, std::int64_t texels, std::size_t columns) {
  constexpr std::int64_t kTexelsAtOnce = 4096;
  std::vector<double> sum(columns), squares(columns);
  std::vector<float> block;
  for (std::int64_t first = 0; first < texels; first += kTexelsAtOnce) {
    const std::int64_t count = std::min(kTexelsAtOnce, texels - first);
    block.resize(columns * static_cast<std::size_t>(count));
    tiles.fill(first, count, std::span<float>(block));
    for (std::size_t j = 0; j < columns; ++j)
      for (std::int64_t i = 0; i < count; ++i) {
        const double v = block[j * static_cast<std::size_t>(count) + static_cast<std::size_t>(i)];
        sum[j] += v;
        squares[j] += v * v;
      }
  }
  const auto n = static_cast<double>(texels);
  for (std::size_t j = 0; j < columns; ++j)
    squares[j] = std::max(0.0, squares[j] / n - sum[j] / n * (sum[j] / n));
  return squares;
}

// Components side by side; a channel's basis says nothing of the others.
void mergeChannels(const std::vector<decomposition::TemporalSvd>& of_channel,
                   const std::vector<std::int32_t>& texels, const ttf::TtfInfo& info,
                   TtfFeatures& result) {
  const auto channels = of_channel.size(), frames = static_cast<std::size_t>(info.frames);
  int rank = 0;
  for (const auto& svd : of_channel) rank += svd.rank;
  const auto terms = static_cast<std::size_t>(rank);
  result.features = Image<float>(info.width, info.height, rank);
  result.basis.assign(frames * channels * terms, 0.0f);
  result.mean.resize(frames * channels);
  int at = 0;
  double power = 0, left = 0;
  for (std::size_t c = 0; c < channels; ++c) {
    const decomposition::TemporalSvd& svd = of_channel[c];
    const auto own = static_cast<std::size_t>(svd.rank);
    takeScores(svd, texels, at, result.features);
    for (std::size_t t = 0; t < frames; ++t) {
      result.mean[t * channels + c] = svd.weight[t] * svd.mean[t];
      std::copy_n(&svd.basis[t * own], own,
                  &result.basis[(t * channels + c) * terms + static_cast<std::size_t>(at)]);
    }
    at += svd.rank;
    double kept = 0;
    for (std::size_t k = 0; k < own; ++k) kept += svd.singular_values[k] * svd.singular_values[k];
    const double error = svd.relative_error * svd.relative_error,
                 whole = error < 1 ? kept / (1 - error) : 0;
    power += whole;
    left += error * whole;
  }
  result.relative_error = power > 0 ? std::sqrt(left / power) : 0;
}

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

void QuiltingSource::codedBlock(RectPx region, std::vector<std::uint8_t>& codes) const {
  codes.resize(static_cast<std::size_t>(info().frames) * region.width * region.height *
               info().channels);
  input_.storedBlock(0, info().frames, region, reinterpret_cast<std::byte*>(codes.data()));
}

TtfFeatures ttfFeatures(const QuiltingSource& source, int rank_max,
                        std::optional<double> rank_error, Progress& progress) {
  const ttf::TtfInfo& info = source.info();
  Tiles tiles(source);
  const std::int64_t m = static_cast<std::int64_t>(info.width) * info.height;
  const std::int64_t n = static_cast<std::int64_t>(info.frames) * info.channels;
  TtfFeatures result;
  decomposition::SvdOptions options;
  options.rank = static_cast<int>(std::min<std::int64_t>(rank_max, std::min(m, n)));
  options.rank_error = rank_error.value_or(0);
  options.certain = kCertain;
  options.centre = true;  // distances are the same, and no rank is spent on the mean picture
  options.weigh = [&](std::span<const double>, std::span<const double> variance) {
    result.weight = frameWeights(variance, info.channels);
    std::vector<float> of_column;
    for (float w : result.weight) of_column.insert(of_column.end(), info.channels, w);
    return of_column;
  };
  const auto fill = [&](std::int64_t first, std::int64_t count, auto block) {
    tiles.fill(first, count, block);
  };
  decomposition::TemporalSvd svd =
      tiles.areSteps()
          ? decomposition::temporalSvd(m, n, decomposition::CodeSource(fill), kCodeStep, options,
                                       progress)
          : decomposition::temporalSvd(m, n, decomposition::SampleSource(fill), options, progress);
  result.features = Image<float>(info.width, info.height, svd.rank);
  result.basis = std::move(svd.basis);
  for (std::size_t j = 0; j < svd.mean.size(); ++j)
    result.mean.push_back(svd.weight[j] * svd.mean[j]);
  result.error_of_rank = std::move(svd.error_of_rank);
  result.relative_error = svd.relative_error;
  takeScores(svd, tiles.texels(), 0, result.features);
  return result;
}

TtfFeatures ttfFeaturesApart(const QuiltingSource& source, int rank_max,
                             std::optional<double> rank_error, Progress& progress) {
  const ttf::TtfInfo& info = source.info();
  Tiles tiles(source);
  const std::int64_t m = static_cast<std::int64_t>(info.width) * info.height;
  const auto channels = static_cast<std::size_t>(info.channels),
             frames = static_cast<std::size_t>(info.frames);
  TtfFeatures result;
  result.weight = frameWeights(varianceOfColumns(tiles, m, frames * channels), info.channels);
  decomposition::SvdOptions options;
  options.rank = static_cast<int>(std::min<std::int64_t>(std::max(1, rank_max / info.channels),
                                                         std::min<std::int64_t>(m, info.frames)));
  options.rank_error = rank_error.value_or(0);
  options.certain = kCertain;
  options.centre = true;
  options.weigh = [&](std::span<const double>, std::span<const double>) { return result.weight; };
  std::vector<decomposition::TemporalSvd> of_channel;
  std::vector<float> all;
  for (std::size_t c = 0; c < channels; ++c)
    of_channel.push_back(decomposition::temporalSvd(
        m, info.frames,
        [&](std::int64_t first, std::int64_t count, std::span<float> block) {
          const auto width = static_cast<std::size_t>(count);
          all.resize(frames * channels * width);
          tiles.fill(first, count, std::span<float>(all));
          for (std::size_t t = 0; t < frames; ++t)
            std::copy_n(&all[(t * channels + c) * width], width, &block[t * width]);
        },
        options, progress));
  mergeChannels(of_channel, tiles.texels(), info, result);
  return result;
}

}  // namespace patina::quilting
