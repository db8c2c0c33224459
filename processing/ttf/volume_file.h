// SPDX-License-Identifier: GPL-3.0-or-later
// A TTF file that is being written, chunk by chunk in any order; whoever fills it knows what with.
// Inside this room only.
#pragma once

#include <cstddef>
#include <filesystem>

#include "processing/ttf/hdf5_bridge.h"
#include "processing/ttf/ttf_file.h"
#include "processing/ttf/write_behind.h"

namespace patina::ttf {

std::size_t bytesOf(SampleType type);
hdf5::Handle storedType(SampleType type);

// Written under a temporary name, which goes with this object unless publish() was called.
class VolumeFile {
 public:
  // Of `about` the times, sources and number of frames are filled in later.
  VolumeFile(const std::filesystem::path& out, const TtfInfo& about, bool compress);
  ~VolumeFile();
  VolumeFile(const VolumeFile&) = delete;
  VolumeFile& operator=(const VolumeFile&) = delete;

  SizePx chunk() const { return chunk_; }
  SizePx chunks() const { return chunks_; }                // across, down
  std::size_t chunkBytes() const { return chunk_bytes_; }  // [kChunkFrames][y][x][c]
  const std::filesystem::path& path() const { return check_.path(); }

  // So many frames, from now on.
  void extend(int frames);
  // Frames [first, first + count) of the chunk at (x, y), which lie at the front of `samples`, of
  // chunkBytes(); where count is less than a chunk's the rest should be zero: same frames, same
  // bytes.
  void writeChunk(int first, int count, int x, int y, const std::byte* samples);
  // Everything else, made safe on disk and given its name. `info` with its times and sources.
  void publish(const TtfInfo& info);

 private:
  void sendOff();
  void writeSeries(const TtfInfo& info);
  void writeAttributes(const TtfInfo& info);
  void attribute(const char* name, hdf5::Id type, const void* value);

  hdf5::Checker check_;
  std::filesystem::path temporary_;
  int height_, width_, channels_;
  bool compress_, published_ = false;
  SizePx chunk_, chunks_;
  std::size_t chunk_bytes_;
  hdf5::Handle file_, frames_, sample_type_;
  WriteBehind behind_;
};

}  // namespace patina::ttf
