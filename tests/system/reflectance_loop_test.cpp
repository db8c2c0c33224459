// SPDX-License-Identifier: GPL-3.0-or-later
// One plan, rehearsed: reflectance and its ageing through archive and calibration, by itself, held
// against the twin's truth. PATINA_REFLECTANCE_STEPS and _SIDE make it long; it prints its table.
#include "tests/system/reflectance_loop.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "processing/stbrdf/stbrdf_file.h"
#include "tests/support/child.h"

namespace patina::testing {
namespace {

int setting(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

class ReflectanceLoop : public ::testing::TestWithParam<const char*> {};

TEST_P(ReflectanceLoop, GivesTheTruthBackByItself) {
  Loop loop;
  loop.specimen = GetParam();
  loop.side_px = setting("PATINA_REFLECTANCE_SIDE", 192);
  loop.bin = setting("PATINA_REFLECTANCE_BIN", 3);
  loop.steps = setting("PATINA_REFLECTANCE_STEPS", 3);
  loop.shadows = setting("PATINA_REFLECTANCE_SHADOWS", 1) != 0;
  const TempFolder folder = TempFolder::inMemory();
  ASSERT_NO_FATAL_FAILURE(prepareLoop(loop, folder));
  const Finished run = runPatina({"rehearse", planOf(folder), "--archive", archiveOf(folder)});
  ASSERT_EQ(run.exit, 0) << run.err;
  const LoopScore s = scoreOf(loop, folder);
  std::printf(
      "| %s | %.4f | %.2f deg | %.1f dB | %.1f dB | %.2f | %.4f | %.3f | %.2f | %.4f | %.3f | "
      "%.4f | %.3f |\n",
      loop.specimen.c_str(), s.diffuse_rms, s.normal_median_deg, s.psnr_db, s.psnr_worst_db,
      s.told_share, s.told_specular_rms, s.told_alpha_rms, s.sure_share, s.sure_specular_rms,
      s.sure_alpha_rms, s.unsure_specular_rms, s.unsure_alpha_rms);
  std::fflush(stdout);
  Progress progress;
  const stbrdf::StbrdfSet ageing = stbrdf::readStbrdfSet(setOf(folder, "stbrdf"), progress);
  EXPECT_EQ(ageing.degree, std::min(loop.degree, loop.steps - 1));
}

INSTANTIATE_TEST_SUITE_P(Specimens, ReflectanceLoop,
                         ::testing::Values("banana_ripening", "copper_patination", "grass_growth",
                                           "paint_cracking", "snow_accumulation", "steel_rusting",
                                           "wood_drying"),
                         [](const auto& about) { return std::string(about.param); });

}  // namespace
}  // namespace patina::testing
