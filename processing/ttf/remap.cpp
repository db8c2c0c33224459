// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/remap.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <future>

#include "processing/ttf/volume_file.h"

namespace patina::ttf {
namespace {

using hdf5::kChunkFrames;

// Texels of a row within one chunk of the result that lie side by side in the input too.
struct Run {
  int x, length, source_x, source_y;
};

class Remap {
 public:
  Remap(const TtfInfo& input, ImageView<const std::int32_t> map, SizePx chunk)
      : input_(input), chunk_(chunk), rows_(static_cast<std::size_t>(map.height)) {
    tbb::parallel_for(0, map.height, [&](int y) {
      for (int x = 0; x < map.width; ++x) add(x, map.at(x, y, 0), map.at(x, y, 1), rows_[y]);
    });
    texel_bytes_ = bytesOf(input.type) * input.channels;
  }

  // Chunk (cx, cy) of the result, [t][y][x][c], from a layer [t][y][x][c] of the input.
  void fill(const std::byte* layer, int frames, int cx, int cy, std::byte* chunk) const {
    const std::size_t in_row = texel_bytes_ * input_.width, in_frame = in_row * input_.height;
    const std::size_t out_row = texel_bytes_ * chunk_.width, out_frame = out_row * chunk_.height;
    const int first = cy * chunk_.height,
              end = std::min(first + chunk_.height, static_cast<int>(rows_.size()));
    const int left = cx * chunk_.width, right = left + chunk_.width;
    for (int t = 0; t < frames; ++t)
      for (int y = first; y < end; ++y) {
        std::byte* row = chunk + t * out_frame + (y - first) * out_row;
        const auto before = [](const Run& run, int x) { return run.x < x; };
        for (auto run = std::lower_bound(rows_[y].begin(), rows_[y].end(), left, before);
             run != rows_[y].end() && run->x < right; ++run)
          std::memcpy(row + (run->x - left) * texel_bytes_,
                      layer + t * in_frame + run->source_y * in_row + run->source_x * texel_bytes_,
                      run->length * texel_bytes_);
      }
  }

 private:
  void add(int x, int source_x, int source_y, std::vector<Run>& row) const {
    if (source_x < 0 || source_y < 0 || source_x >= input_.width || source_y >= input_.height)
      throw ProcessingError(Exit::kUsage, "texel " + std::to_string(source_x) + "," +
                                              std::to_string(source_y) +
                                              " lies beyond the texture it should come from");
    if (!row.empty() && x % chunk_.width != 0) {
      Run& last = row.back();
      if (source_y == last.source_y && source_x == last.source_x + last.length) {
        ++last.length;
        return;
      }
    }
    row.push_back({x, 1, source_x, source_y});
  }

  const TtfInfo& input_;
  SizePx chunk_;
  std::vector<std::vector<Run>> rows_;
  std::size_t texel_bytes_ = 0;
};

// Three layers are on their way: one is read, one copied, one written.
class Pipeline {
 public:
  Pipeline(const TtfReader& input, const Remap& remap, VolumeFile& file)
      : input_(input), remap_(remap), file_(file) {
    const TtfInfo& info = input.info();
    for (auto& layer : in_)
      layer.resize(bytesOf(info.type) * info.channels * info.width * info.height * kChunkFrames);
    for (auto& layer : out_)
      layer.resize(file.chunkBytes() * file.chunks().width * file.chunks().height);
  }

  void run(Progress& progress) {
    const int frames = input_.info().frames, layers = (frames + kChunkFrames - 1) / kChunkFrames;
    progress.begin("frames", layers);
    read(0);
    for (int layer = 0; layer <= layers; ++layer) {
      tbb::parallel_invoke(
          [&] {
            if (layer + 1 < layers) read(layer + 1);
            if (layer > 0) write(layer - 1);
          },
          [&] {
            if (layer < layers) copy(layer);
          });
      if (layer > 0) progress.step();
    }
  }

 private:
  int framesOf(int layer) const {
    return std::min(kChunkFrames, input_.info().frames - layer * kChunkFrames);
  }
  void read(int layer) {
    const TtfInfo& info = input_.info();
    input_.storedBlock(layer * kChunkFrames, framesOf(layer), {0, 0, info.width, info.height},
                       in_[layer % 2].data());
  }
  void copy(int layer) {
    const SizePx chunks = file_.chunks();
    std::vector<std::byte>& out = out_[layer % 2];
    if (framesOf(layer) < kChunkFrames) std::fill(out.begin(), out.end(), std::byte{0});
    tbb::parallel_for(0, chunks.width * chunks.height, [&](int i) {
      remap_.fill(in_[layer % 2].data(), framesOf(layer), i % chunks.width, i / chunks.width,
                  out.data() + i * file_.chunkBytes());
    });
  }
  void write(int layer) {
    const SizePx chunks = file_.chunks();
    file_.extend(layer * kChunkFrames + framesOf(layer));
    const std::byte* samples = out_[layer % 2].data();
    for (int y = 0; y < chunks.height; ++y)
      for (int x = 0; x < chunks.width; ++x, samples += file_.chunkBytes())
        file_.writeChunk(layer * kChunkFrames, framesOf(layer), x, y, samples);
  }

  const TtfReader& input_;
  const Remap& remap_;
  VolumeFile& file_;
  std::array<std::vector<std::byte>, 2> in_, out_;
};

}  // namespace

std::int64_t remapBytes(const TtfInfo& input, SizePx out) {
  const std::int64_t texels =
      std::int64_t{input.width} * input.height + std::int64_t{out.width} * out.height;
  return 2 * kChunkFrames * texels * input.channels *
         static_cast<std::int64_t>(bytesOf(input.type));
}

void remapTtf(const TtfReader& input, ImageView<const std::int32_t> source_xy,
              const std::filesystem::path& out, const std::function<std::string()>& provenance_json,
              Progress& progress) {
  TtfInfo info = input.info();
  info.width = source_xy.width;
  info.height = source_xy.height;
  info.source.assign(info.source.size(), Sha256{});
  VolumeFile file(out, info, false);
  const Remap remap(input.info(), source_xy, file.chunk());
  std::future<std::string> provenance = std::async(std::launch::async, provenance_json);
  Pipeline(input, remap, file).run(progress);
  info.provenance_json = provenance.get();
  file.publish(info);
}

}  // namespace patina::ttf
