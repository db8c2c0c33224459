// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <half.h>
#include <hdf5.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "processing/ttf/hdf5_bridge.h"
#include "processing/ttf/ttf_file.h"

namespace patina::ttf {
namespace {

using hdf5::Checker;
using hdf5::Handle;
using hdf5::kChunkFrames;
using hdf5::kChunkTexels;
using hdf5::Session;

std::size_t bytesOf(SampleType type) { return type == SampleType::kF32 ? 4 : 2; }

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
template <class Float>
int convert(const std::uint16_t* in, int count, double scale, Float* out) {
  const float gain = static_cast<float>(scale / 65535.0);
  for (int i = 0; i < count; ++i) out[i] = in[i] * gain;
  return 0;
}

void syncPath(const Checker& check, const std::filesystem::path& path, int flags) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  const bool ok = fd >= 0 && ::fsync(fd) == 0;
  const int error = errno;
  if (fd >= 0) ::close(fd);
  check.require(ok, "cannot be made safe on disk: " + std::string(std::strerror(error)));
}

}  // namespace

struct TtfWriter::State {
  State(const std::filesystem::path& out, const TtfInfo& about, bool compressed);
  ~State();

  template <class T>
  void add(ImageView<const T> frame, double time_s, const Sha256& source);
  template <class T, class Stored>
  void scatter(ImageView<const T> frame);
  void flushLayer();
  void writeChunk(hsize_t y, hsize_t x, const std::byte* samples);
  void writeSeries();
  void writeAttributes();
  void attribute(const char* name, hid_t type, const void* value);

  Checker check;
  std::filesystem::path temporary;
  TtfInfo info;
  bool compress, published = false;
  int chunk_height, chunk_width, chunks_down, chunks_across;
  std::size_t chunk_bytes;
  std::vector<std::byte> layer;  // [chunk y][chunk x][t][y][x][c]: as the chunks lie in the file
  int layer_frames = 0;
  std::int64_t clipped = 0;
  Handle file, frames, sample_type;
};

TtfWriter::State::State(const std::filesystem::path& out, const TtfInfo& about, bool compressed)
    : check(out, Exit::kIo),
      temporary(out.parent_path() / ("." + out.filename().string() + ".partial")),
      info(about),
      compress(compressed) {
  if (about.width < 1 || about.height < 1 || about.channels < 1 || about.channels > 64)
    throw ProcessingError(
        Exit::kUsage, out.string() + ": a frame of " + std::to_string(about.width) + "x" +
                          std::to_string(about.height) + " with " + std::to_string(about.channels) +
                          " channels; allowed: at least 1x1, 1 to 64 channels");
  if (!(about.scale > 0 && std::isfinite(about.scale)))
    throw ProcessingError(Exit::kUsage, out.string() + ": scale is " + std::to_string(about.scale) +
                                            "; allowed: above 0");
  info.frames = 0;
  info.time_s.clear();
  info.source.clear();
  chunk_height = std::min(kChunkTexels, info.height);
  chunk_width = std::min(kChunkTexels, info.width);
  chunks_down = (info.height + chunk_height - 1) / chunk_height;
  chunks_across = (info.width + chunk_width - 1) / chunk_width;
  chunk_bytes = bytesOf(info.type) * kChunkFrames * chunk_height * chunk_width * info.channels;
  layer.resize(chunk_bytes * chunks_down * chunks_across);

  const Session session;
  const Handle file_access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(file_access.id(), H5F_CLOSE_STRONG);
  H5Pset_file_locking(file_access.id(), false, true);  // the temporary name is ours alone
  file = {H5Fcreate(temporary.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, file_access.id()), H5Fclose};
  if (!file.valid())
    throw ProcessingError(Exit::kCannotCreate, out.string() + ": cannot be created there");

  sample_type =
      info.type == SampleType::kF16
          ? hdf5::halfType()
          : Handle(H5Tcopy(info.type == SampleType::kU16 ? H5T_STD_U16LE : H5T_IEEE_F32LE),
                   H5Tclose);
  const auto h = static_cast<hsize_t>(info.height), w = static_cast<hsize_t>(info.width),
             c = static_cast<hsize_t>(info.channels);
  const hsize_t chunk[4] = {kChunkFrames, static_cast<hsize_t>(chunk_height),
                            static_cast<hsize_t>(chunk_width), c};
  const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(layout.id(), 4, chunk);
  H5Pset_obj_track_times(layout.id(), false);  // else the bytes hang on the hour
  if (compress) {
    H5Pset_shuffle(layout.id());
    H5Pset_deflate(layout.id(), 1);
  }
  const Handle space = hdf5::simpleSpace({0, h, w, c}, {H5S_UNLIMITED, h, w, c});
  frames = check.handle(H5Dcreate2(file.id(), "frames", sample_type.id(), space.id(), H5P_DEFAULT,
                                   layout.id(), H5P_DEFAULT),
                        H5Dclose, "/frames cannot be created");
}

TtfWriter::State::~State() {
  frames.close();
  file.close();
  if (!published) ::unlink(temporary.c_str());
}

template <class T, class Stored>
void TtfWriter::State::scatter(ImageView<const T> frame) {
  const int c = info.channels, t = layer_frames;
  std::atomic<std::int64_t> beyond{0};
  std::atomic<int> bad_row{-1};
  tbb::parallel_for(tbb::blocked_range<int>(0, frame.height, 32), [&](const auto& range) {
    for (int y = range.begin(); y < range.end(); ++y)
      for (int cx = 0; cx < chunks_across; ++cx) {
        const int x = cx * chunk_width, width = std::min(chunk_width, frame.width - x);
        const std::size_t chunk = static_cast<std::size_t>(y / chunk_height) * chunks_across + cx;
        const std::size_t texel =
            (static_cast<std::size_t>(t) * chunk_height + y % chunk_height) * chunk_width;
        auto* out = reinterpret_cast<Stored*>(layer.data() + chunk * chunk_bytes) + texel * c;
        const int count =
            convert(frame.row(y) + static_cast<std::ptrdiff_t>(x) * c, width * c, info.scale, out);
        if (count < 0)
          bad_row = y;
        else
          beyond += count;
      }
  });
  if (bad_row >= 0)
    throw ProcessingError(Exit::kBadData, check.path().string() + ": frame " +
                                              std::to_string(info.frames) +
                                              " holds a value that is no finite number, in row " +
                                              std::to_string(bad_row));
  clipped += beyond;
}

template <class T>
void TtfWriter::State::add(ImageView<const T> frame, double time_s, const Sha256& source) {
  const std::string which = check.path().string() + ": frame " + std::to_string(info.frames);
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
  const std::size_t frame_bytes = chunk_bytes / kChunkFrames;
  if (layer_frames < kChunkFrames)  // what no frame fills is zero: same frames, same bytes
    for (std::size_t chunk = 0; chunk < layer.size(); chunk += chunk_bytes)
      std::fill_n(layer.begin() + chunk + layer_frames * frame_bytes,
                  (kChunkFrames - layer_frames) * frame_bytes, std::byte{0});
  const Session session;
  const hsize_t extent[4] = {static_cast<hsize_t>(info.frames), static_cast<hsize_t>(info.height),
                             static_cast<hsize_t>(info.width), static_cast<hsize_t>(info.channels)};
  check.require(H5Dset_extent(frames.id(), extent) >= 0, "cannot be extended");
  for (int y = 0; y < chunks_down; ++y)
    for (int x = 0; x < chunks_across; ++x)
      writeChunk(y, x,
                 layer.data() + chunk_bytes * (static_cast<std::size_t>(y) * chunks_across + x));
  layer_frames = 0;
}

void TtfWriter::State::writeChunk(hsize_t y, hsize_t x, const std::byte* samples) {
  const hsize_t first = info.frames - layer_frames, c = info.channels;
  const hsize_t start[4] = {first, y * chunk_height, x * chunk_width, 0};
  herr_t written;
  if (!compress) {  // as it lies, past the library's copying
    written = H5Dwrite_chunk(frames.id(), H5P_DEFAULT, 0, start, chunk_bytes, samples);
  } else {
    const hsize_t count[4] = {static_cast<hsize_t>(layer_frames),
                              std::min<hsize_t>(chunk_height, info.height - start[1]),
                              std::min<hsize_t>(chunk_width, info.width - start[2]), c};
    const hsize_t origin[4] = {0, 0, 0, 0};
    const Handle memory = hdf5::simpleSpace(
        {kChunkFrames, static_cast<hsize_t>(chunk_height), static_cast<hsize_t>(chunk_width), c});
    H5Sselect_hyperslab(memory.id(), H5S_SELECT_SET, origin, nullptr, count, nullptr);
    const Handle target(H5Dget_space(frames.id()), H5Sclose);
    H5Sselect_hyperslab(target.id(), H5S_SELECT_SET, start, nullptr, count, nullptr);
    written =
        H5Dwrite(frames.id(), sample_type.id(), memory.id(), target.id(), H5P_DEFAULT, samples);
  }
  check.require(written >= 0, "cannot be written (is the disk full?)");
}

void TtfWriter::State::attribute(const char* name, hid_t type, const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute =
      check.handle(H5Acreate2(file.id(), name, type, space.id(), H5P_DEFAULT, H5P_DEFAULT),
                   H5Aclose, std::string("attribute ") + name + " cannot be created");
  check.require(H5Awrite(attribute.id(), type, value) >= 0,
                std::string("attribute ") + name + " cannot be written");
}

void TtfWriter::State::writeAttributes() {
  const Handle text = hdf5::anyTextType();
  const auto addText = [&](const char* name, const std::string& value) {
    const char* pointer = value.c_str();
    attribute(name, text.id(), &pointer);
  };
  const std::int64_t t0 = toNs(info.t0_utc);
  addText("schema", "patina.ttf/1");
  addText("encoding", "linear");
  attribute("scale", H5T_IEEE_F64LE, &info.scale);
  attribute("mm_per_texel", H5T_IEEE_F64LE, &info.mm_per_texel);
  attribute("t0_utc_ns", H5T_STD_I64LE, &t0);
  addText("provenance", info.provenance_json);
}

void TtfWriter::State::writeSeries() {
  const Handle space = hdf5::simpleSpace({static_cast<hsize_t>(info.frames)});
  const auto series = [&](const char* name, hid_t type, const void* values) {
    const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(layout.id(), false);
    const Handle set = check.handle(
        H5Dcreate2(file.id(), name, type, space.id(), H5P_DEFAULT, layout.id(), H5P_DEFAULT),
        H5Dclose, std::string("/") + name + " cannot be created");
    check.require(H5Dwrite(set.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0,
                  std::string("/") + name + " cannot be written");
  };
  series("time_s", H5T_IEEE_F64LE, info.time_s.data());
  std::string digits;
  for (const Sha256& hash : info.source) digits += hash.hex();
  series("source_sha256", hdf5::textType(64).id(), digits.data());
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
    throw ProcessingError(Exit::kBadData, s.check.path().string() + ": there is no frame to write");
  {
    const Session session;
    s.flushLayer();
    s.writeSeries();
    s.writeAttributes();
    s.frames.close();
    s.check.require(s.file.close(), "cannot be written to its end (is the disk full?)");
  }
  syncPath(s.check, s.temporary, O_RDWR);
  s.check.require(::rename(s.temporary.c_str(), s.check.path().c_str()) == 0,
                  "cannot be given its name: " + std::string(std::strerror(errno)));
  s.published = true;
  const std::filesystem::path folder = s.check.path().parent_path();
  syncPath(s.check, folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
}

}  // namespace patina::ttf
