// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/volume_file.h"

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

namespace patina::ttf {
namespace {

using hdf5::Checker;
using hdf5::Handle;
using hdf5::kChunkFrames;
using hdf5::kChunkTexels;
using hdf5::Session;

void syncPath(const Checker& check, const std::filesystem::path& path, int flags) {
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC);
  const bool ok = fd >= 0 && ::fsync(fd) == 0;
  const int error = errno;
  if (fd >= 0) ::close(fd);
  check.require(ok, "cannot be made safe on disk: " + std::string(std::strerror(error)));
}

}  // namespace

std::size_t bytesOf(SampleType type) {
  return type == SampleType::kF32 ? 4 : type == SampleType::kU8 ? 1 : 2;
}

Handle storedType(SampleType type) {
  const Session session;
  switch (type) {
    case SampleType::kU8:
      return {H5Tcopy(H5T_STD_U8LE), H5Tclose};
    case SampleType::kU16:
      return {H5Tcopy(H5T_STD_U16LE), H5Tclose};
    case SampleType::kF16:
      return hdf5::halfType();
    case SampleType::kF32:
      break;
  }
  return {H5Tcopy(H5T_IEEE_F32LE), H5Tclose};
}

VolumeFile::VolumeFile(const std::filesystem::path& out, const TtfInfo& about, bool compress)
    : check_(out, Exit::kIo),
      temporary_(out.parent_path() / ("." + out.filename().string() + ".partial")),
      height_(about.height),
      width_(about.width),
      channels_(about.channels),
      compress_(compress) {
  if (about.width < 1 || about.height < 1 || about.channels < 1 || about.channels > 64)
    throw ProcessingError(
        Exit::kUsage, out.string() + ": a frame of " + std::to_string(about.width) + "x" +
                          std::to_string(about.height) + " with " + std::to_string(about.channels) +
                          " channels; allowed: at least 1x1, 1 to 64 channels");
  if (!(about.scale > 0 && std::isfinite(about.scale)))
    throw ProcessingError(Exit::kUsage, out.string() + ": scale is " + std::to_string(about.scale) +
                                            "; allowed: above 0");
  chunk_ = {std::min(kChunkTexels, width_), std::min(kChunkTexels, height_)};
  chunks_ = {(width_ + chunk_.width - 1) / chunk_.width,
             (height_ + chunk_.height - 1) / chunk_.height};
  chunk_bytes_ = bytesOf(about.type) * kChunkFrames * chunk_.height * chunk_.width * channels_;

  const Session session;
  const Handle file_access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(file_access.id(), H5F_CLOSE_STRONG);
  H5Pset_file_locking(file_access.id(), false, true);  // the temporary name is ours alone
  file_ = {H5Fcreate(temporary_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, file_access.id()), H5Fclose};
  if (!file_.valid())
    throw ProcessingError(Exit::kCannotCreate, out.string() + ": cannot be created there");

  sample_type_ = storedType(about.type);
  const auto h = static_cast<hsize_t>(height_), w = static_cast<hsize_t>(width_),
             c = static_cast<hsize_t>(channels_);
  const hsize_t chunk[4] = {kChunkFrames, static_cast<hsize_t>(chunk_.height),
                            static_cast<hsize_t>(chunk_.width), c};
  const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(layout.id(), 4, chunk);
  H5Pset_obj_track_times(layout.id(), false);  // else the bytes hang on the hour
  if (compress_) {
    H5Pset_shuffle(layout.id());
    H5Pset_deflate(layout.id(), 1);
  }
  const Handle space = hdf5::simpleSpace({0, h, w, c}, {H5S_UNLIMITED, h, w, c});
  frames_ = check_.handle(H5Dcreate2(file_.id(), "frames", sample_type_.id(), space.id(),
                                     H5P_DEFAULT, layout.id(), H5P_DEFAULT),
                          H5Dclose, "/frames cannot be created");
}

VolumeFile::~VolumeFile() {
  frames_.close();
  file_.close();
  if (!published_) ::unlink(temporary_.c_str());
}

void VolumeFile::extend(int frames) {
  const Session session;
  const hsize_t extent[4] = {static_cast<hsize_t>(frames), static_cast<hsize_t>(height_),
                             static_cast<hsize_t>(width_), static_cast<hsize_t>(channels_)};
  check_.require(H5Dset_extent(frames_.id(), extent) >= 0, "cannot be extended");
}

void VolumeFile::writeChunk(int first, int count, int x, int y, const std::byte* samples) {
  const Session session;
  const hsize_t c = static_cast<hsize_t>(channels_);
  const hsize_t start[4] = {static_cast<hsize_t>(first), static_cast<hsize_t>(y * chunk_.height),
                            static_cast<hsize_t>(x * chunk_.width), 0};
  herr_t written;
  if (!compress_) {  // as it lies, past the library's copying
    written = H5Dwrite_chunk(frames_.id(), H5P_DEFAULT, 0, start, chunk_bytes_, samples);
  } else {
    const hsize_t counts[4] = {
        static_cast<hsize_t>(count),
        std::min<hsize_t>(static_cast<hsize_t>(chunk_.height), height_ - start[1]),
        std::min<hsize_t>(static_cast<hsize_t>(chunk_.width), width_ - start[2]), c};
    const hsize_t origin[4] = {0, 0, 0, 0};
    const Handle memory = hdf5::simpleSpace(
        {kChunkFrames, static_cast<hsize_t>(chunk_.height), static_cast<hsize_t>(chunk_.width), c});
    H5Sselect_hyperslab(memory.id(), H5S_SELECT_SET, origin, nullptr, counts, nullptr);
    const Handle target(H5Dget_space(frames_.id()), H5Sclose);
    H5Sselect_hyperslab(target.id(), H5S_SELECT_SET, start, nullptr, counts, nullptr);
    written =
        H5Dwrite(frames_.id(), sample_type_.id(), memory.id(), target.id(), H5P_DEFAULT, samples);
  }
  check_.require(written >= 0, "cannot be written (is the disk full?)");
  sendOff();
}

void VolumeFile::sendOff() {
  void* fd = nullptr;
  if (H5Fget_vfd_handle(file_.id(), H5P_DEFAULT, &fd) < 0 || !fd) return;
  const int error =
      behind_.wrote(*static_cast<const int*>(fd), static_cast<std::int64_t>(chunk_bytes_));
  check_.require(error == 0, "cannot be written: " + std::string(std::strerror(error)));
}

void VolumeFile::attribute(const char* name, hdf5::Id type, const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute =
      check_.handle(H5Acreate2(file_.id(), name, type, space.id(), H5P_DEFAULT, H5P_DEFAULT),
                    H5Aclose, std::string("attribute ") + name + " cannot be created");
  check_.require(H5Awrite(attribute.id(), type, value) >= 0,
                 std::string("attribute ") + name + " cannot be written");
}

void VolumeFile::writeAttributes(const TtfInfo& info) {
  const Handle text = hdf5::anyTextType();
  const auto addText = [&](const char* name, const std::string& value) {
    const char* pointer = value.c_str();
    attribute(name, text.id(), &pointer);
  };
  const std::int64_t t0 = toNs(info.t0_utc);
  addText("schema", "patina.ttf/1");
  addText("encoding", info.type == SampleType::kU8 ? "srgb" : "linear");
  attribute("scale", H5T_IEEE_F64LE, &info.scale);
  attribute("mm_per_texel", H5T_IEEE_F64LE, &info.mm_per_texel);
  attribute("t0_utc_ns", H5T_STD_I64LE, &t0);
  addText("provenance", info.provenance_json);
}

void VolumeFile::writeSeries(const TtfInfo& info) {
  const Handle space = hdf5::simpleSpace({static_cast<hsize_t>(info.frames)});
  const auto series = [&](const char* name, hid_t type, const void* values) {
    const Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(layout.id(), false);
    const Handle set = check_.handle(
        H5Dcreate2(file_.id(), name, type, space.id(), H5P_DEFAULT, layout.id(), H5P_DEFAULT),
        H5Dclose, std::string("/") + name + " cannot be created");
    check_.require(H5Dwrite(set.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0,
                   std::string("/") + name + " cannot be written");
  };
  series("time_s", H5T_IEEE_F64LE, info.time_s.data());
  std::string digits;
  for (const Sha256& hash : info.source) digits += hash.hex();
  series("source_sha256", hdf5::textType(64).id(), digits.data());
}

void VolumeFile::publish(const TtfInfo& info) {
  {
    const Session session;
    writeSeries(info);
    writeAttributes(info);
    frames_.close();
    check_.require(file_.close(), "cannot be written to its end (is the disk full?)");
  }
  syncPath(check_, temporary_, O_RDWR);
  check_.require(::rename(temporary_.c_str(), check_.path().c_str()) == 0,
                 "cannot be given its name: " + std::string(std::strerror(errno)));
  published_ = true;
  const std::filesystem::path folder = check_.path().parent_path();
  syncPath(check_, folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
}

}  // namespace patina::ttf
