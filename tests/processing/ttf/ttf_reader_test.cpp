// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <hdf5.h>

#include <functional>

#include "processing/ttf/hdf5_bridge.h"
#include "tests/processing/ttf/small_volume.h"
#include "tests/support/temp_folder.h"

namespace patina::ttf {
namespace {

using patina::testing::readFile;
using patina::testing::TempFolder;
using patina::testing::writeFile;

// The one line with which `path` is refused as bad data; empty when it was taken.
std::string refusal(const std::filesystem::path& path) {
  try {
    const TtfReader reader(path);
    for (int t = 0; t < reader.info().frames; ++t) reader.frame(t);
    return "";
  } catch (const ProcessingError& e) {
    EXPECT_EQ(e.exit(), Exit::kBadData);
    EXPECT_EQ(std::string(e.what()).rfind(path.string(), 0), 0u) << e.what();
    return std::string(e.what()).substr(path.string().size() + 2);
  }
}

// A volume of 3 frames, then changed by `spoil` through the HDF5 library itself.
std::string refusalOfSpoilt(const std::function<void(hid_t file)>& spoil) {
  const TempFolder folder = TempFolder::inMemory();
  writeVolume(folder / "a.h5", {3, 6, 5, 3});
  const hid_t file = H5Fopen((folder / "a.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  spoil(file);
  H5Fclose(file);
  return refusal(folder / "a.h5");
}

void replaceDataset(hid_t file, const char* name, hid_t type, std::initializer_list<hsize_t> dims) {
  H5Ldelete(file, name, H5P_DEFAULT);
  const hdf5::Handle space = hdf5::simpleSpace(dims);
  H5Dclose(H5Dcreate2(file, name, type, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
}

TEST(TtfReader, GivesBackWhatIsKnownOfTheVolume) {
  const TempFolder folder = TempFolder::inMemory();
  writeVolume(folder / "a.h5", {3, 6, 5, 3});
  TtfReader reader(folder / "a.h5");
  const TtfReader moved = std::move(reader);
  const TtfInfo& info = moved.info();
  EXPECT_EQ(info.frames, 3);
  EXPECT_EQ(info.height, 6);
  EXPECT_EQ(info.width, 5);
  EXPECT_EQ(info.channels, 3);
  EXPECT_EQ(info.type, SampleType::kU16);
  EXPECT_EQ(info.scale, 1.0);
  EXPECT_EQ(info.mm_per_texel, 0.25);
  EXPECT_EQ(formatUtc(info.t0_utc), "2024-05-01T12:00:00.000Z");
  EXPECT_EQ(info.provenance_json, R"({"command":"test"})");
}

TEST(TtfReader, CutsBlocksOutOfSpaceAndTime) {
  const TempFolder folder = TempFolder::inMemory();
  const Shape s{19, 140, 150, 3};
  for (bool compress : {false, true}) {
    writeVolume(folder / "a.h5", s, SampleType::kU16, compress);
    const TtfReader reader(folder / "a.h5");
    const RectPx region{120, 100, 20, 33};
    const std::vector<std::uint16_t> block = reader.block(6, 11, region);
    ASSERT_EQ(block.size(), 11u * 33 * 20 * 3);
    std::size_t i = 0;
    for (int t = 6; t < 17; ++t) {
      const Image<std::uint16_t> frame = sampleFrame(s, t);
      for (int y = 100; y < 133; ++y)
        for (int x = 120; x < 140; ++x)
          for (int c = 0; c < 3; ++c) ASSERT_EQ(block[i++], frame.at(x, y, c));
    }
  }
}

TEST(TtfReader, RefusesFramesAndRegionsThatAreNotThere) {
  const TempFolder folder = TempFolder::inMemory();
  writeVolume(folder / "a.h5", {3, 6, 5, 3});
  const TtfReader reader(folder / "a.h5");
  EXPECT_THROW(reader.frame(3), ProcessingError);
  EXPECT_THROW(reader.frame(-1), ProcessingError);
  EXPECT_THROW(reader.block(0, 4, {0, 0, 5, 6}), ProcessingError);
  EXPECT_THROW(reader.block(0, 1, {1, 0, 5, 6}), ProcessingError);
  EXPECT_THROW(reader.block(0, 1, {0, 0, 0, 6}), ProcessingError);
  EXPECT_THROW(reader.block(0, 1, {0, -1, 1, 1}), ProcessingError);
}

TEST(TtfReader, RefusesWhatIsNoFileOrNoHdf5) {
  const TempFolder folder = TempFolder::inMemory();
  EXPECT_EQ(refusal(folder / "absent.h5"), "there is no such file");
  EXPECT_EQ(refusal(folder.path()), "there is no such file");
  writeFile(folder / "empty.h5", "");
  EXPECT_EQ(refusal(folder / "empty.h5"), "is not a whole HDF5 file");
  writeFile(folder / "text.h5", std::string(5000, 'x'));
  EXPECT_EQ(refusal(folder / "text.h5"), "is not a whole HDF5 file");
}

TEST(TtfReader, RefusesAFileTruncatedAnywhere) {
  const TempFolder folder = TempFolder::inMemory();
  writeVolume(folder / "a.h5", {9, 40, 50, 3});
  const std::string whole = readFile(folder / "a.h5");
  for (std::size_t bytes = 0; bytes < whole.size(); bytes += 1 + whole.size() / 97) {
    writeFile(folder / "cut.h5", whole.substr(0, bytes));
    EXPECT_NE(refusal(folder / "cut.h5"), "") << bytes << " of " << whole.size() << " bytes";
  }
}

TEST(TtfReader, RefusesAVolumeOfAnotherShapeOrType) {
  EXPECT_EQ(refusalOfSpoilt([](hid_t f) { H5Ldelete(f, "frames", H5P_DEFAULT); }),
            "holds no /frames: not a time-varying texture");
  EXPECT_EQ(refusalOfSpoilt([](hid_t f) {
              replaceDataset(f, "frames", H5T_STD_U16LE, {3, 6, 5});
            }),
            "/frames has 3 dimensions, not the 4 [t][y][x][c]");
  EXPECT_EQ(refusalOfSpoilt([](hid_t f) {
              replaceDataset(f, "frames", H5T_STD_I32LE, {3, 6, 5, 3});
            }),
            "/frames is neither u8 (encoded) nor u16 nor f16 nor f32 (linear)");
  EXPECT_EQ(refusalOfSpoilt([](hid_t f) {
              replaceDataset(f, "frames", H5T_STD_U16LE, {3, 100'000, 100'000, 3});
            }),
            "/frames claims frames of 100000x100000x3");
}

TEST(TtfReader, RefusesSeriesThatDoNotMatchTheFrames) {
  EXPECT_EQ(refusalOfSpoilt([](hid_t f) { H5Ldelete(f, "time_s", H5P_DEFAULT); }),
            "/time_s is missing");
  EXPECT_EQ(refusalOfSpoilt([](hid_t f) { replaceDataset(f, "time_s", H5T_IEEE_F64LE, {4}); }),
            "/time_s has 4 entries for 3 frames");
  EXPECT_EQ(refusalOfSpoilt(
                [](hid_t f) { replaceDataset(f, "source_sha256", hdf5::textType(20).id(), {3}); }),
            "/source_sha256 does not hold texts of 64 digits");
  EXPECT_EQ(refusalOfSpoilt(
                [](hid_t f) { replaceDataset(f, "source_sha256", hdf5::textType(64).id(), {3}); }),
            "/source_sha256 is no hash at frame 0");
  EXPECT_EQ(refusalOfSpoilt([](hid_t f) {
              const double falling[3] = {0, 2, 1};
              const hid_t set = H5Dopen2(f, "time_s", H5P_DEFAULT);
              H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, falling);
              H5Dclose(set);
            }),
            "/time_s does not rise at frame 2");
}

TEST(TtfReader, RefusesANewerSchemaAndAnotherEncoding) {
  const auto retext = [](const char* name, const char* text) {
    return refusalOfSpoilt([=](hid_t f) {
      H5Adelete(f, name);
      const hdf5::Handle type = hdf5::textType(32);
      const hdf5::Handle space(H5Screate(H5S_SCALAR), H5Sclose);
      const hid_t a = H5Acreate2(f, name, type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT);
      char padded[32] = {};
      std::snprintf(padded, sizeof padded, "%s", text);
      H5Awrite(a, type.id(), padded);
      H5Aclose(a);
    });
  };
  EXPECT_EQ(retext("schema", "patina.ttf/9"),
            "is of schema 'patina.ttf/9'; this program reads patina.ttf/1");
  EXPECT_EQ(retext("encoding", "srgb"), "is encoded as 'srgb', not linear");
  EXPECT_EQ(retext("scale", "one"), "attribute scale is not one number");
}

}  // namespace
}  // namespace patina::ttf
