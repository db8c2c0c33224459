// SPDX-License-Identifier: GPL-3.0-or-later
#include <hdf5.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "processing/image/encoding.h"
#include "processing/ttf/hdf5_bridge.h"
#include "processing/ttf/ttf_file.h"
#include "processing/ttf/volume_file.h"

namespace patina::ttf {
namespace {

using hdf5::Checker;
using hdf5::Handle;
using hdf5::kChunkFrames;
using hdf5::Session;

constexpr std::int64_t kTexelsMax = 400'000'000;             // of one frame: no more than a picture
constexpr std::size_t kCacheBytes = std::size_t{192} << 20;  // of chunks

struct Shape {
  hsize_t t = 0, y = 0, x = 0, c = 0;
};

Shape shapeOf(const Checker& check, hid_t set) {
  const Handle space = check.handle(H5Dget_space(set), H5Sclose, "/frames has no shape");
  hsize_t dims[H5S_MAX_RANK] = {};
  const int rank = H5Sget_simple_extent_ndims(space.id());
  check.require(rank == 4,
                "/frames has " + std::to_string(rank) + " dimensions, not the 4 [t][y][x][c]");
  H5Sget_simple_extent_dims(space.id(), dims, nullptr);
  const Shape s{dims[0], dims[1], dims[2], dims[3]};
  check.require(s.t >= 1 && s.t <= 1'000'000, "/frames has " + std::to_string(s.t) + " frames");
  check.require(
      s.y >= 1 && s.x >= 1 && s.c >= 1 && s.c <= 64 && s.y <= kTexelsMax && s.x <= kTexelsMax / s.y,
      "/frames claims frames of " + std::to_string(s.x) + "x" + std::to_string(s.y) + "x" +
          std::to_string(s.c));
  return s;
}

SampleType sampleTypeOf(const Checker& check, hid_t set) {
  const Handle type = check.handle(H5Dget_type(set), H5Tclose, "/frames has no type");
  const std::size_t bytes = H5Tget_size(type.id());
  const H5T_class_t kind = H5Tget_class(type.id());
  if (kind == H5T_INTEGER && bytes <= 2 && H5Tget_sign(type.id()) == H5T_SGN_NONE)
    return bytes == 1 ? SampleType::kU8 : SampleType::kU16;
  if (kind == H5T_FLOAT && bytes == 2) return SampleType::kF16;
  if (kind == H5T_FLOAT && bytes == 4) return SampleType::kF32;
  check.fail("/frames is neither u8 (encoded) nor u16 nor f16 nor f32 (linear)");
}

// Opens /name, one-dimensional, of `length`.
Handle openSeries(const Checker& check, hid_t file, const char* name, hsize_t length) {
  const std::string label = std::string("/") + name;
  Handle set = check.handle(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose, label + " is missing");
  const Handle space(H5Dget_space(set.id()), H5Sclose);
  hsize_t found = 0;
  check.require(H5Sget_simple_extent_ndims(space.id()) == 1, label + " is not one-dimensional");
  H5Sget_simple_extent_dims(space.id(), &found, nullptr);
  check.require(found == length, label + " has " + std::to_string(found) + " entries for " +
                                     std::to_string(length) + " frames");
  return set;
}

std::vector<double> readTimes(const Checker& check, hid_t file, hsize_t length) {
  const Handle set = openSeries(check, file, "time_s", length);
  std::vector<double> time_s(length);
  check.require(
      H5Dread(set.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, time_s.data()) >= 0,
      "/time_s cannot be read as numbers");
  for (std::size_t i = 0; i < time_s.size(); ++i)
    check.require(std::isfinite(time_s[i]) && (i == 0 || time_s[i] >= time_s[i - 1]),
                  "/time_s does not rise at frame " + std::to_string(i));
  return time_s;
}

std::vector<Sha256> readHashes(const Checker& check, hid_t file, hsize_t length) {
  const Handle set = openSeries(check, file, "source_sha256", length);
  const Handle stored(H5Dget_type(set.id()), H5Tclose);
  check.require(H5Tget_class(stored.id()) == H5T_STRING && H5Tis_variable_str(stored.id()) == 0 &&
                    H5Tget_size(stored.id()) >= 64,
                "/source_sha256 does not hold texts of 64 digits");
  const Handle text = hdf5::textType(64);
  std::string digits(length * 64, '\0');
  check.require(H5Dread(set.id(), text.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, digits.data()) >= 0,
                "/source_sha256 cannot be read");
  std::vector<Sha256> hashes;
  for (hsize_t i = 0; i < length; ++i) {
    const std::string_view one(digits.data() + i * 64, 64);
    check.require(one.find_first_not_of("0123456789abcdef") == one.npos,
                  "/source_sha256 is no hash at frame " + std::to_string(i));
    hashes.push_back(Sha256::fromHex(one));
  }
  return hashes;
}

template <class T>
T readNumber(const Checker& check, hid_t file, const char* name, hid_t memory_type, T absent) {
  if (H5Aexists(file, name) <= 0) return absent;
  const Handle attribute(H5Aopen(file, name, H5P_DEFAULT), H5Aclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  T value{};
  check.require(H5Sget_simple_extent_npoints(space.id()) == 1 &&
                    H5Aread(attribute.id(), memory_type, &value) >= 0,
                std::string("attribute ") + name + " is not one number");
  return value;
}

std::string readText(const Checker& check, hid_t file, const char* name,
                     const std::string& absent) {
  if (H5Aexists(file, name) <= 0) return absent;
  const std::string wrong = std::string("attribute ") + name + " is not one text";
  const Handle attribute(H5Aopen(file, name, H5P_DEFAULT), H5Aclose);
  const Handle space(H5Aget_space(attribute.id()), H5Sclose);
  const Handle stored(H5Aget_type(attribute.id()), H5Tclose);
  check.require(
      H5Tget_class(stored.id()) == H5T_STRING && H5Sget_simple_extent_npoints(space.id()) == 1,
      wrong);
  if (H5Tis_variable_str(stored.id()) > 0) {
    char* text = nullptr;
    check.require(H5Aread(attribute.id(), stored.id(), &text) >= 0 && text, wrong);
    std::string value(text);
    H5free_memory(text);
    return value;
  }
  std::string value(H5Tget_size(stored.id()), '\0');
  check.require(H5Aread(attribute.id(), stored.id(), value.data()) >= 0, wrong);
  value.resize(std::strlen(value.c_str()));
  return value;
}

}  // namespace

struct TtfReader::State {
  explicit State(const std::filesystem::path& path);
  void openFrames(const Shape& shape);
  void read(int t_first, int count, RectPx region, hid_t memory_type, void* out) const;

  Checker check;
  TtfInfo info;
  Handle file, frames;
};

TtfReader::State::State(const std::filesystem::path& path) : check(path, Exit::kBadData) {
  std::error_code error;
  check.require(std::filesystem::is_regular_file(path, error), "there is no such file");
  const Session session;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
  H5Pset_file_locking(access.id(), false, true);  // published files never change
  file = check.handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose,
                      "is not a whole HDF5 file");
  frames = check.handle(H5Dopen2(file.id(), "frames", H5P_DEFAULT), H5Dclose,
                        "holds no /frames: not a time-varying texture");
  const Shape shape = shapeOf(check, frames.id());
  info.type = sampleTypeOf(check, frames.id());
  info.frames = static_cast<int>(shape.t);
  info.height = static_cast<int>(shape.y);
  info.width = static_cast<int>(shape.x);
  info.channels = static_cast<int>(shape.c);
  info.time_s = readTimes(check, file.id(), shape.t);
  info.source = readHashes(check, file.id(), shape.t);

  const std::string schema = readText(check, file.id(), "schema", "patina.ttf/1");
  check.require(schema == "patina.ttf/1",
                "is of schema '" + schema + "'; this program reads patina.ttf/1");
  const std::string encoding = readText(check, file.id(), "encoding", "linear"),
                    wanted = info.type == SampleType::kU8 ? "srgb" : "linear";
  check.require(encoding == wanted, "is encoded as '" + encoding + "', not " + wanted);
  info.scale = readNumber(check, file.id(), "scale", H5T_NATIVE_DOUBLE, 1.0);
  check.require(info.scale > 0 && std::isfinite(info.scale), "attribute scale is not above 0");
  info.mm_per_texel = readNumber(check, file.id(), "mm_per_texel", H5T_NATIVE_DOUBLE, 0.0);
  info.t0_utc =
      utcFromNs(readNumber(check, file.id(), "t0_utc_ns", H5T_NATIVE_INT64, std::int64_t{0}));
  info.provenance_json = readText(check, file.id(), "provenance", "{}");
  openFrames(shape);
}

// Anew, with a chunk cache that holds one layer, so that frames read in order decode each chunk
// once. Where a layer is too large: none, and the library reads parts of (uncompressed) chunks.
void TtfReader::State::openFrames(const Shape& shape) {
  const Handle layout(H5Dget_create_plist(frames.id()), H5Pclose);
  if (H5Pget_layout(layout.id()) != H5D_CHUNKED) return;
  hsize_t chunk[4] = {};
  check.require(H5Pget_chunk(layout.id(), 4, chunk) == 4, "/frames has odd chunks");
  const hsize_t bytes = chunk[0] * chunk[1] * chunk[2] * chunk[3] * bytesOf(info.type);
  const hsize_t chunks =
      ((shape.y + chunk[1] - 1) / chunk[1]) * ((shape.x + chunk[2] - 1) / chunk[2]);
  const bool filtered = H5Pget_nfilters(layout.id()) > 0;
  const bool fits = chunks <= kCacheBytes / bytes;
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access.id(), 12421, fits || filtered ? kCacheBytes : 0, 1.0);
  frames = check.handle(H5Dopen2(file.id(), "frames", access.id()), H5Dclose,
                        "/frames cannot be opened");
}

void TtfReader::State::read(int t_first, int count, RectPx region, hid_t memory_type,
                            void* out) const {
  const auto bad = [&](const char* what) {
    throw ProcessingError(Exit::kUsage, check.path().string() + ": " + what + " beyond the " +
                                            std::to_string(info.frames) + " frames of " +
                                            std::to_string(info.width) + "x" +
                                            std::to_string(info.height) + " was asked for");
  };
  if (t_first < 0 || count < 1 || count > info.frames - t_first) bad("a frame");
  if (region.x < 0 || region.y < 0 || region.width < 1 || region.height < 1 ||
      region.width > info.width - region.x || region.height > info.height - region.y)
    bad("a region");
  const Session session;
  const hsize_t start[4] = {static_cast<hsize_t>(t_first), static_cast<hsize_t>(region.y),
                            static_cast<hsize_t>(region.x), 0};
  const hsize_t size[4] = {static_cast<hsize_t>(count), static_cast<hsize_t>(region.height),
                           static_cast<hsize_t>(region.width), static_cast<hsize_t>(info.channels)};
  const Handle memory(H5Screate_simple(4, size, nullptr), H5Sclose);
  const Handle stored(H5Dget_space(frames.id()), H5Sclose);
  H5Sselect_hyperslab(stored.id(), H5S_SELECT_SET, start, nullptr, size, nullptr);
  check.require(
      H5Dread(frames.id(), memory_type, memory.id(), stored.id(), H5P_DEFAULT, out) >= 0,
      "frames from " + std::to_string(t_first) + " on cannot be read: the file is damaged");
}

namespace {

// What a code of u8 means, linear / scale.
const std::vector<float>& codes() {
  static const std::vector<float> table = [] {
    std::vector<float> linear;
    for (int code = 0; code < 256; ++code) linear.push_back(linearFromSrgb(code / 255.0f));
    return linear;
  }();
  return table;
}

void forSamples(std::size_t count, const auto& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 16), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
  });
}

}  // namespace

TtfReader::TtfReader(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {}
TtfReader::~TtfReader() = default;
TtfReader::TtfReader(TtfReader&&) noexcept = default;
TtfReader& TtfReader::operator=(TtfReader&&) noexcept = default;
const TtfInfo& TtfReader::info() const { return state_->info; }

std::vector<std::uint16_t> TtfReader::block(int t_first, int count, RectPx region) const {
  const TtfInfo& info = state_->info;
  const std::size_t samples = static_cast<std::size_t>(std::max(count, 0)) *
                              std::max(region.width, 0) * std::max(region.height, 0) *
                              info.channels;
  std::vector<std::uint16_t> out(samples);
  if (info.type == SampleType::kU16) {
    state_->read(t_first, count, region, H5T_NATIVE_UINT16, out.data());
    return out;
  }
  if (info.type == SampleType::kU8) {
    std::vector<std::uint8_t> stored(samples);
    state_->read(t_first, count, region, H5T_NATIVE_UINT8, stored.data());
    std::vector<std::uint16_t> linear;
    for (float v : codes()) linear.push_back(static_cast<std::uint16_t>(v * 65535 + 0.5f));
    forSamples(samples, [&](std::size_t i) { out[i] = linear[stored[i]]; });
    return out;
  }
  std::vector<float> linear(samples);
  state_->read(t_first, count, region, H5T_NATIVE_FLOAT, linear.data());
  const float gain = static_cast<float>(65535.0 / info.scale);
  forSamples(samples, [&](std::size_t i) {
    const float v = linear[i] * gain + 0.5f;  // NaN becomes 0
    out[i] = static_cast<std::uint16_t>(v > 0 ? std::min(v, 65535.0f) : 0);
  });
  return out;
}

Image<std::uint16_t> TtfReader::frame(int t) const {
  const TtfInfo& info = state_->info;
  Image<std::uint16_t> out(0, 0, info.channels);
  std::vector<std::uint16_t> samples = block(t, 1, {0, 0, info.width, info.height});
  out = Image<std::uint16_t>(info.width, info.height, info.channels);
  out.texels() = std::move(samples);
  return out;
}

std::vector<float> TtfReader::linearBlock(int t_first, int count, RectPx region) const {
  const TtfInfo& info = state_->info;
  std::vector<float> out(static_cast<std::size_t>(std::max(count, 0)) * std::max(region.width, 0) *
                         std::max(region.height, 0) * info.channels);
  if (info.type == SampleType::kU8) {
    std::vector<std::uint8_t> stored(out.size());
    state_->read(t_first, count, region, H5T_NATIVE_UINT8, stored.data());
    const float full = static_cast<float>(info.scale);
    forSamples(out.size(), [&](std::size_t i) { out[i] = codes()[stored[i]] * full; });
    return out;
  }
  if (info.type != SampleType::kU16) {
    state_->read(t_first, count, region, H5T_NATIVE_FLOAT, out.data());
    return out;
  }
  const std::vector<std::uint16_t> samples = block(t_first, count, region);
  const float gain = static_cast<float>(info.scale / 65535.0);
  forSamples(samples.size(), [&](std::size_t i) { out[i] = samples[i] * gain; });
  return out;
}

void TtfReader::storedBlock(int t_first, int count, RectPx region, std::byte* out) const {
  const Handle type = storedType(state_->info.type);
  state_->read(t_first, count, region, type.id(), out);
}

Image<float> TtfReader::linearFrame(int t) const {
  const TtfInfo& info = state_->info;
  Image<float> out(info.width, info.height, info.channels);
  out.texels() = linearBlock(t, 1, {0, 0, info.width, info.height});
  return out;
}

}  // namespace patina::ttf
