// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/sidecar_file.h"

#include <gmock/gmock.h>

#include "tests/support/temp_folder.h"

namespace patina {
namespace {

PictureMetadata known() {
  PictureMetadata m;
  m.taken_utc = parseUtc("2024-05-01T12:00:00.250Z");
  m.exposure = std::chrono::milliseconds(20);
  m.iso = Iso{400};
  m.f_number = FNumber{5.6};
  m.camera = "Patina Twin";
  return m;
}

TEST(Sidecar, GivesBackWhatWasWritten) {
  const std::string xmp = encodeSidecar(known());
  EXPECT_THAT(xmp, ::testing::HasSubstr("x:xmpmeta"));
  const PictureMetadata read = decodeSidecar(xmp);
  EXPECT_EQ(read.taken_utc, known().taken_utc);
  EXPECT_EQ(read.exposure, known().exposure);
  EXPECT_EQ(read.iso, known().iso);
  EXPECT_EQ(read.f_number, known().f_number);
  EXPECT_EQ(read.camera, "Patina Twin");
  PictureMetadata slow;
  slow.exposure = std::chrono::seconds(30);
  EXPECT_EQ(decodeSidecar(encodeSidecar(slow)).exposure, slow.exposure);
}

TEST(Sidecar, StandsInForWhatTheFileDoesNotSay) {
  const auto folder = testing::TempFolder::inMemory();
  const Bytes png = encodePng(Image<std::uint8_t>(4, 4, 3, 9).view());
  writeFileAtomically(folder / "a.png", png);
  EXPECT_FALSE(readMetadataOf(folder / "a.png", png).exposure);
  writeFileAtomically(sidecarOf(folder / "a.png"), encodeSidecar(known()));
  EXPECT_EQ(sidecarOf(folder / "a.png").filename(), "a.png.xmp");
  EXPECT_EQ(readMetadataOf(folder / "a.png", png).exposure, known().exposure);
  EXPECT_EQ(readMetadataOf(folder / "a.png", png).taken_utc, known().taken_utc);
}

TEST(Sidecar, ThatIsMalformedSaysNothing) {
  for (const char* text : {"", "<x", "no xmp at all"}) {
    EXPECT_FALSE(decodeSidecar(text).exposure) << text;
    EXPECT_FALSE(decodeSidecar(text).taken_utc) << text;
  }
}

}  // namespace
}  // namespace patina
