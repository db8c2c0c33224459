// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/albedo_calibration.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "capture/workflow/gain_field_calibration.h"
#include "processing/image/picture_file.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TempFolder;
using ::testing::ThrowsMessage;

class Albedos : public ::testing::Test {
 protected:
  Albedos() {
    testing::makeRun(archive_, {{{testing::MadeShot{}}}});
    request_.pictures.folder = folder_ / "card";
    request_.pictures.camera = "cam0";
    request_.pictures.light = "key";
    request_.targets = {{{20, 20, 20, 20}, {0.36, 0.36, 0.36}}};
    request_.command = "patina calibrate albedo";
    plant("card", 0.36f);
  }
  // Light that grows to the right, on a card of `reflectance`.
  void plant(const std::string& name, float reflectance) {
    Image<float> card(160, 120, 3);
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 160; ++x)
        for (int c = 0; c < 3; ++c)
          card.at(x, y, c) = reflectance * (0.5f + 0.002f * static_cast<float>(x));
    std::filesystem::create_directories(folder_ / name);
    writeExr(folder_ / name / "a.exr", card.view());
  }
  AlbedoOutcome make() {
    Progress progress;
    return makeAlbedo(archive_, request_, testing::now(), progress);
  }
  TempFolder folder_ = TempFolder::inMemory();
  const std::filesystem::path archive_ = folder_ / "archive";
  AlbedoRequest request_;
};

TEST_F(Albedos, AreReadBackAsTheyWereKept) {
  const AlbedoOutcome made = make();
  const KeptCalibration kept = keepAlbedo(archive_, request_, made, testing::now());
  EXPECT_EQ(kept.row.kind, "albedo");
  const calibration::AlbedoScale back = readAlbedo(kept.path);
  EXPECT_EQ(back.channels, 3);
  EXPECT_EQ(back.scale, made.scale.scale);
  EXPECT_EQ(back.deviance, made.scale.deviance);
}

TEST_F(Albedos, UseTheArchivesFieldOfTheirLamp) {
  EXPECT_THAT(make().notes, ::testing::ElementsAre(HasSubstr("taken for even")));
  plant("white", 0.9f);
  GainFieldRequest field;
  field.pictures = {folder_ / "white", {}, {}, "cam0", "key", 16};
  Progress progress;
  keepGainField(archive_, field, makeGainField(archive_, field, testing::now(), progress),
                testing::now());
  const AlbedoOutcome with = make();
  EXPECT_THAT(with.notes, IsEmpty());
  EXPECT_NEAR(with.scale.scale[1], 0.9, 1e-3) << "the white target's own reflectance";
}

TEST_F(Albedos, OfDamagedFilesAreRefused) {
  testing::writeFile(folder_ / "a.json",
                     R"({"schema":"patina.albedo/1","channels":3,"scale_r":1})");
  EXPECT_THAT(([&] { readAlbedo(folder_ / "a.json"); }),
              ThrowsMessage<WorkflowError>(HasSubstr("no scale")));
  testing::writeFile(folder_ / "a.json", "[]");
  EXPECT_THROW(readAlbedo(folder_ / "a.json"), WorkflowError);
  testing::writeFile(folder_ / "a.json", "{}");
  EXPECT_THAT(([&] { readAlbedo(folder_ / "a.json"); }),
              ThrowsMessage<WorkflowError>(HasSubstr("no albedo scale")));
  request_.pictures.light.clear();
  EXPECT_THROW(keepAlbedo(archive_, request_, make(), testing::now()), WorkflowError);
}

}  // namespace
}  // namespace patina::workflow
