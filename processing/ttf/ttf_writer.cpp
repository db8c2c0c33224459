// SPDX-License-Identifier: GPL-3.0-or-later
#include <half.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>

#include "processing/image/encoding.h"
#include "processing/ttf/ttf_file.h"
#include "processing/ttf/volume_file.h"

namespace patina::ttf {
namespace {

using hdf5::kChunkFrames;

// A row of linear values as stored samples. Returns how many were clipped, -1: not finite.
int convert(const float* in, int count, double scale, std::uint16_t* out) {
  const float gain = static_cast<float>(65535.0 / scale);
  int clipped = 0, bad = 0;
  for (int i = 0; i < count; ++i) {
    const float v = in[i] * gain;
    bad += !(std::abs(in[i]) <= 3e38f);
    clipped += (in[i] < 0) + (v > 65535.0f);
    const float rounded = std::min(std::max(v, 0.0f), 65535.0f) + 0.5f;
    out[i] = static_cast<std::uint16_t>(rounded);
  }
  return bad ? -1 : clipped;
}
int convert(const float* in, int count, double, half* out) {
  int bad = 0;
  for (int i = 0; i < count; ++i) {
    bad += !(std::abs(in[i]) <= 65504.0f);
    out[i] = in[i];
  }
  return bad ? -1 : 0;
}
int convert(const float* in, int count, double, float* out) {
  int bad = 0;
  for (int i = 0; i < count; ++i) bad += !(std::abs(in[i]) <= 3e38f);
  std::copy_n(in, count, out);
  return bad ? -1 : 0;
}
int convert(const std::uint16_t* in, int count, double, std::uint16_t* out) {
  std::copy_n(in, count, out);
  return 0;
}
// Codes of sRGB, by a table of all u16.
const std::vector<std::uint8_t>& codes() {
  static const std::vector<std::uint8_t> table = [] {
    std::vector<std::uint8_t> code;
    for (int v = 0; v < 65536; ++v)
      code.push_back(static_cast<std::uint8_t>(srgbFromLinear(v / 65535.0f) * 255 + 0.5f));
    return code;
  }();
  return table;
}
int convert(const std::uint16_t* in, int count, double, std::uint8_t* out) {
  for (int i = 0; i < count; ++i) out[i] = codes()[in[i]];
  return 0;
}
int convert(const float* in, int count, double scale, std::uint8_t* out) {
  std::vector<std::uint16_t> linear(count);
  const int clipped = convert(in, count, scale, linear.data());
  convert(linear.data(), count, scale, out);
  return clipped;
}
template <class Float>
int convert(const std::uint16_t* in, int count, double scale, Float* out) {
  const float gain = static_cast<float>(scale / 65535.0);
  for (int i = 0; i < count; ++i) out[i] = in[i] * gain;
  return 0;
}

}  // namespace

struct TtfWriter::State {
  State(const std::filesystem::path& out, const TtfInfo& about, bool compress)
      : file(out, about, compress), info(about) {
    info.frames = 0;
    info.time_s.clear();
    info.source.clear();
    layer.resize(file.chunkBytes() * file.chunks().width * file.chunks().height);
  }

  template <class T>
  void add(ImageView<const T> frame, double time_s, const Sha256& source);
  template <class T, class Stored>
  void scatter(ImageView<const T> frame);
  void flushLayer();

  VolumeFile file;
  TtfInfo info;
  std::vector<std::byte> layer;  // [chunk y][chunk x][t][y][x][c]: as the chunks lie in the file
  int layer_frames = 0;
  std::int64_t clipped = 0;
};

template <class T, class Stored>
void TtfWriter::State::scatter(ImageView<const T> frame) {
  const int c = info.channels, t = layer_frames;
  const SizePx size = file.chunk();
  std::atomic<std::int64_t> beyond{0};
  std::atomic<int> bad_row{-1};
  tbb::parallel_for(tbb::blocked_range<int>(0, frame.height, 32), [&](const auto& range) {
    for (int y = range.begin(); y < range.end(); ++y)
      for (int cx = 0; cx < file.chunks().width; ++cx) {
        const int x = cx * size.width, width = std::min(size.width, frame.width - x);
        const std::size_t chunk =
            static_cast<std::size_t>(y / size.height) * file.chunks().width + cx;
        const std::size_t texel =
            (static_cast<std::size_t>(t) * size.height + y % size.height) * size.width;
        auto* out = reinterpret_cast<Stored*>(layer.data() + chunk * file.chunkBytes()) + texel * c;
        const int count =
            convert(frame.row(y) + static_cast<std::ptrdiff_t>(x) * c, width * c, info.scale, out);
        if (count < 0)
          bad_row = y;
        else
          beyond += count;
      }
  });
  if (bad_row >= 0)
    throw ProcessingError(Exit::kBadData, file.path().string() + ": frame " +
                                              std::to_string(info.frames) +
                                              " holds a value that is no finite number, in row " +
                                              std::to_string(bad_row));
  clipped += beyond;
}

template <class T>
void TtfWriter::State::add(ImageView<const T> frame, double time_s, const Sha256& source) {
  const std::string which = file.path().string() + ": frame " + std::to_string(info.frames);
  if (frame.width != info.width || frame.height != info.height || frame.channels != info.channels)
    throw ProcessingError(Exit::kBadData,
                          which + " is " + std::to_string(frame.width) + "x" +
                              std::to_string(frame.height) + "x" + std::to_string(frame.channels) +
                              ", the volume " + std::to_string(info.width) + "x" +
                              std::to_string(info.height) + "x" + std::to_string(info.channels));
  if (!std::isfinite(time_s) || (!info.time_s.empty() && time_s < info.time_s.back()))
    throw ProcessingError(Exit::kBadData, which + " is at " + std::to_string(time_s) +
                                              " s, before the one added last");
  switch (info.type) {
    case SampleType::kU8:
      scatter<T, std::uint8_t>(frame);
      break;
    case SampleType::kU16:
      scatter<T, std::uint16_t>(frame);
      break;
    case SampleType::kF16:
      scatter<T, half>(frame);
      break;
    case SampleType::kF32:
      scatter<T, float>(frame);
      break;
  }
  ++info.frames;
  ++layer_frames;
  info.time_s.push_back(time_s);
  info.source.push_back(source);
  if (layer_frames == kChunkFrames) flushLayer();
}

void TtfWriter::State::flushLayer() {
  if (layer_frames == 0) return;
  const std::size_t chunk_bytes = file.chunkBytes(), frame_bytes = chunk_bytes / kChunkFrames;
  if (layer_frames < kChunkFrames)  // what no frame fills is zero: same frames, same bytes
    for (std::size_t chunk = 0; chunk < layer.size(); chunk += chunk_bytes)
      std::fill_n(layer.begin() + chunk + layer_frames * frame_bytes,
                  (kChunkFrames - layer_frames) * frame_bytes, std::byte{0});
  file.extend(info.frames);
  const std::byte* samples = layer.data();
  for (int y = 0; y < file.chunks().height; ++y)
    for (int x = 0; x < file.chunks().width; ++x, samples += chunk_bytes)
      file.writeChunk(info.frames - layer_frames, layer_frames, x, y, samples);
  layer_frames = 0;
}

TtfWriter::TtfWriter(const std::filesystem::path& path, const TtfInfo& info, bool compress)
    : state_(std::make_unique<State>(path, info, compress)) {}
TtfWriter::~TtfWriter() = default;

void TtfWriter::add(ImageView<const float> linear, double time_s, const Sha256& source) {
  state_->add(linear, time_s, source);
}
void TtfWriter::add(ImageView<const std::uint16_t> samples, double time_s, const Sha256& source) {
  state_->add(samples, time_s, source);
}
std::int64_t TtfWriter::clippedSamples() const { return state_->clipped; }

void TtfWriter::close() {
  State& s = *state_;
  if (s.info.frames == 0)
    throw ProcessingError(Exit::kBadData, s.file.path().string() + ": there is no frame to write");
  s.flushLayer();
  s.file.publish(s.info);
}

}  // namespace patina::ttf
