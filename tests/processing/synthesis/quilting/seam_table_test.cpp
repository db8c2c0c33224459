// SPDX-License-Identifier: GPL-3.0-or-later
// Can seams be seen? Every specimen of the twin and two real photographs,
// quilted by copies alone and with a correction beside seams; the long form
// (PATINA_SEAM_TABLE) takes all of them at 256x256 and holds the corrected ones
// to the figure of the material itself.
#include <gtest/gtest.h>

#include <cstdlib>

#include "devices/twin/specimen_picture.h"
#include "processing/image/picture_file.h"
#include "processing/synthesis/quilting/ttf_quilting.h"
#include "tests/processing/synthesis/quilting/textures.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina::quilting {
namespace {

using patina::testing::TempFolder;

struct Case {
  int side, frames, result;
};

void writeSpecimen(const std::filesystem::path& path, const std::string& name, const Case& c) {
  using namespace devices::twin;
  const auto specimen = makeSpecimen(name, 1);
  ttf::TtfInfo info;
  info.width = info.height = c.side;
  ttf::TtfWriter writer(path, info);
  for (int t = 0; t < c.frames; ++t) {
    const Image<float> frame = shadedPicture(*specimen, static_cast<double>(t) / (c.frames - 1),
                                             {c.side, c.side}, {-230, 260, 320});
    writer.add(frame.view(), t, Sha256{});
  }
  writer.close();
}

void writePhotograph(const std::filesystem::path& path, const std::filesystem::path& picture) {
  const Picture photograph = readPicture(picture);
  ttf::TtfInfo info;
  info.width = photograph.linear.width();
  info.height = photograph.linear.height();
  info.channels = photograph.linear.channels();
  ttf::TtfWriter writer(path, info);
  writer.add(photograph.linear.view(), 0, Sha256{});
  writer.close();
}

struct Row {
  double cut = 0, recut = 0, blended = 0, wrapped = 0, in_place = 0, areas = 0, blend_px = 0;
};

Row measure(const TempFolder& folder, const std::string& name, SizePx size) {
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  QuiltingOptions o;
  o.size = size;
  const auto ratio = [&] {
    return quiltTtf(input, o, folder / "out.h5", noProvenance, progress).seam_ratio_frames;
  };
  Row row;
  o.seam_sweeps = 0;
  row.cut = ratio();
  o.seam_sweeps = QuiltingOptions().seam_sweeps;
  row.recut = ratio();
  o.blend_auto = true;
  const QuiltingReport blended = quiltTtf(input, o, folder / "out.h5", noProvenance, progress);
  row.blended = blended.seam_ratio_frames;
  row.in_place = blended.seam_ratio_in_place;
  row.areas = blended.seam_ratio_worst;
  row.blend_px = blended.blend_px;
  o.tile = true;
  row.wrapped = ratio();
  std::printf("%-18s %6.2f %6.2f %6.2f %6.2f %6.2f %6.2f %6.1f\n", name.c_str(), row.cut, row.recut,
              row.blended, row.wrapped, row.in_place, row.areas, row.blend_px);
  std::fflush(stdout);
  return row;
}

TEST(SeamTable, OfAllSpecimensAndTwoPhotographs) {
  const bool all = std::getenv("PATINA_SEAM_TABLE") != nullptr;
  const Case c = all ? Case{256, 24, 384} : Case{72, 5, 100};
  const TempFolder folder = TempFolder::inMemory();
  std::printf(
      "gradient across seams / inside, median over frames: copies cut "
      "as laid, all seams cut "
      "anew,\n"
      "corrected as far as needed, the same wrapped around; corrected, "
      "against what the sources "
      "show\n"
      "at the very seams; of areas, in the worst frame, corrected; "
      "reach of the correction in px\n");
  std::vector<std::string> names{"steel_rusting"};
  if (all)
    names = {"banana_ripening",   "copper_patination", "grass_growth", "paint_cracking",
             "snow_accumulation", "steel_rusting",     "wood_drying"};
  const auto judge = [&](const Row& row, const std::string& name) {
    // The cheaper cut need not have the lower ratio: it may run through
    // livelier places.
    EXPECT_LE(row.recut, 1.2 * row.cut) << name;
    if (!all) return;
    for (const double ratio : {row.blended, row.wrapped}) {
      EXPECT_GE(ratio, 0.9) << name;
      EXPECT_LE(ratio, 1.1) << name;
    }
    EXPECT_GE(row.in_place, 0.85) << name;
    EXPECT_LE(row.in_place, 1.2) << name;
    EXPECT_LE(row.areas, 1.6) << name;
  };
  for (const std::string& name : names) {
    writeSpecimen(folder / "in.h5", name, c);
    judge(measure(folder, name, {c.result, c.result}), name);
  }
  if (!all) return;
  for (const char* name : {"grass", "gravel"}) {
    PATINA_TEST_DATA_OR_SKIP(picture, "textures/" + std::string(name) + ".png");
    writePhotograph(folder / "in.h5", picture);
    judge(measure(folder, name, {768, 768}), name);
  }
}

}  // namespace
}  // namespace patina::quilting
