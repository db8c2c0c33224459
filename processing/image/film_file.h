// SPDX-License-Identifier: GPL-3.0-or-later
// Films in (anything libavformat reads, GIF included) and out (H.264, yuv420p).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "processing/image/image.h"

namespace patina {

// Pull reader. Frames are counted by decoding them: a container's own count may lie.
class FilmReader {
 public:
  explicit FilmReader(const std::filesystem::path& path);  // throws ProcessingError(kBadData)
  ~FilmReader();
  FilmReader(const FilmReader&) = delete;
  FilmReader& operator=(const FilmReader&) = delete;

  // Next frame, 8-bit sRGB [h][w][3]; nothing at the end. Throws on a corrupt stream.
  std::optional<Image<std::uint8_t>> next();
  std::optional<Nanoseconds> lastFrameTime() const;  // presentation time of that frame, if known

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct FilmOptions {
  double frames_per_second = 25;  // (0, 240]
  int quality_crf = 18;           // 0 (lossless) .. 51
  void check() const;
};

// The file appears whole at close() or not at all. Odd sizes are padded by repeating the last row
// or column, never cropped. Decoded frames do not depend on the number of threads.
class FilmWriter {
 public:
  FilmWriter(const std::filesystem::path& mp4, SizePx size, const FilmOptions& options);
  ~FilmWriter();  // without close(): nothing is left
  FilmWriter(const FilmWriter&) = delete;
  FilmWriter& operator=(const FilmWriter&) = delete;

  void add(ImageView<const std::uint8_t> srgb);  // [h][w][3], of the size given
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace patina
