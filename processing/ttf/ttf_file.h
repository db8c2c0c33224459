// SPDX-License-Identifier: GPL-3.0-or-later
// A time-varying texture on disk: HDF5, /frames [t][y][x][c], /time_s [t], /source_sha256 [t]
// (design, section 6). Readable with h5py alone. Streams: memory is a few chunks, at any length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/sha256.h"

namespace patina::ttf {

// kU8 is encoded (sRGB of linear / scale); all others are linear.
enum class SampleType { kU8, kU16, kF16, kF32 };

struct TtfInfo {
  int frames = 0, height = 0, width = 0, channels = 3;
  SampleType type = SampleType::kU16;
  double scale = 1.0;       // linear value of sample 65535 (u16) or 255 (u8)
  double mm_per_texel = 0;  // 0: unknown
  UtcTime t0_utc;
  std::vector<double> time_s;
  std::vector<Sha256> source;   // per frame; zero hash: synthesised
  std::string provenance_json;  // command, options, seed, version, inputs by hash
};

// Written under a temporary name, closed, fsynced and renamed by close(): whole or not at all.
// Holds 8 frames (one layer of chunks). Same frames and info, same bytes.
class TtfWriter {
 public:
  // `info.frames`, time_s and source are filled as frames are added.
  TtfWriter(const std::filesystem::path& path, const TtfInfo& info, bool compress = false);
  ~TtfWriter();
  TtfWriter(const TtfWriter&) = delete;
  TtfWriter& operator=(const TtfWriter&) = delete;
  // Times may not fall; a NaN or an infinity is refused (kBadData). u16: rounded, clamped.
  void add(ImageView<const float> linear, double time_s, const Sha256& source);
  // Samples as they are stored; in a float volume sample * scale / 65535, in one of u8 the nearest
  // code (that of a sample read from such a volume is the same again).
  void add(ImageView<const std::uint16_t> samples, double time_s, const Sha256& source);
  std::int64_t clippedSamples() const;  // of the floats added: outside [0, scale]
  void close();                         // throws ProcessingError(kIo) and leaves nothing

 private:
  struct State;
  std::unique_ptr<State> state_;
};

class TtfReader {  // Thread-bound.
 public:
  explicit TtfReader(const std::filesystem::path& path);  // ProcessingError(kBadData) with why
  ~TtfReader();
  TtfReader(TtfReader&&) noexcept;
  TtfReader& operator=(TtfReader&&) noexcept;
  const TtfInfo& info() const;
  Image<std::uint16_t> frame(int t) const;  // u16 samples; floats are divided by scale, clamped
  Image<float> linearFrame(int t) const;    // times scale
  // Frames [t_first, t_first + count) of a region: [t][y][x][c], u16.
  std::vector<std::uint16_t> block(int t_first, int count, RectPx region) const;
  std::vector<float> linearBlock(int t_first, int count, RectPx region) const;  // the same, linear
  // The same as they are stored, into room for count * region * channels of them.
  void storedBlock(int t_first, int count, RectPx region, std::byte* out) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace patina::ttf
