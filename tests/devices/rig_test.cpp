// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/rig.h"

#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "tests/support/temp_folder.h"

namespace patina::devices {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr const char* kRig = R"(
name = "bench"
[[camera]]
id = "cam0"
backend = "twin"
serial = "0042"
settings = { formats = "jpg", gain = 2 }
[[light]]
id = "key"
backend = "twin"
position_mm = [300, -20.5, 400]
between = "keep"
[[light]]
id = "lamp"
backend = "dmx"
address = "1/17"
[[sensor]]
id = "lux0"
backend = "twin"
quantity = "illuminance"
band = [0.97, 1.03]
[[trigger]]
id = "line"
backend = "gpio"
address = "chip0/4"
[patch]
camera = "cam0"
rect_px = [8, 440, 64, 64]
[twin]
specimen = "copper_patination"
size = "640x512"
faults = "faults/week.toml"
)";

std::string errorOf(const std::string& toml) {
  try {
    parseRig(toml, "rig.toml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

// A rig of one camera with more text behind it.
std::string withCamera(const std::string& rest) {
  return "[[camera]]\nid = \"cam0\"\nbackend = \"twin\"\n" + rest;
}

TEST(Rig, GivesBackWhatItsFileSays) {
  const RigSpec rig = parseRig(kRig, "/lab/rig.toml");
  EXPECT_EQ(rig.name, "bench");
  ASSERT_EQ(rig.cameras.size(), 1u);
  EXPECT_EQ(rig.cameras[0].serial, "0042");
  EXPECT_THAT(rig.cameras[0].settings, ElementsAre(Pair("formats", "jpg"), Pair("gain", "2")));
  ASSERT_EQ(rig.lights.size(), 2u);
  EXPECT_THAT(rig.lights[0].position_mm, ElementsAre(300, -20.5, 400));
  EXPECT_EQ(rig.lights[0].between, Between::kKeep);
  EXPECT_EQ(rig.lights[1].between, Between::kOff);
  EXPECT_EQ(rig.lights[1].address, "1/17");
  ASSERT_EQ(rig.sensors.size(), 1u);
  EXPECT_EQ(rig.sensors[0].quantity, Quantity::kIlluminance);
  EXPECT_THAT(*rig.sensors[0].band, ElementsAre(0.97, 1.03));
  EXPECT_EQ(rig.triggers.at(0).address, "chip0/4");
  EXPECT_EQ(rig.patches.at(0).rect_px, (RectPx{8, 440, 64, 64}));
  ASSERT_TRUE(rig.twin.has_value());
  EXPECT_EQ(rig.twin->specimen, "copper_patination");
  EXPECT_EQ(rig.twin->size, (SizePx{640, 512}));
  EXPECT_EQ(rig.twin->faults, "/lab/faults/week.toml");
  EXPECT_EQ(rig.toml, kRig);
}

TEST(Rig, DevicesMayHangOnAnotherMachineOfTheRig) {
  const std::string host = "[[host]]\nid = \"pi\"\naddress = \"pi.local:8461\"\nkey = \"pi.key\"\n";
  const std::string light = "[[light]]\nid = \"key\"\nbackend = \"artnet\"\non = \"pi\"\n";
  const RigSpec rig = parseRig(withCamera(light + host), "/lab/rig.toml");
  EXPECT_EQ(rig.hosts.at(0).address, "pi.local:8461");
  EXPECT_EQ(rig.hosts.at(0).key, "/lab/pi.key");
  EXPECT_EQ(rig.lights.at(0).on, "pi");
  EXPECT_THAT(errorOf(withCamera(light)), HasSubstr("\"pi\", which is no [[host]] of this rig"));
  EXPECT_THAT(errorOf(withCamera("[[host]]\nid = \"pi\"\naddress = \"pi\"\nkey = \"k\"\n")),
              HasSubstr("must be NAME:PORT"));
}

TEST(Rig, APowerSwitchAndAShutterLineNameDevicesOfTheRig) {
  const RigSpec rig = parseRig(
      withCamera("power = \"hub\"\ncall_limit = \"300ms\"\n[[trigger]]\nid = \"line\"\n"
                 "backend = \"gpio\"\ncameras = [\"cam0\"]\nsettings = { pulse_ms = 80 }\n"),
      "rig.toml");
  EXPECT_EQ(rig.cameras[0].power, "hub");
  const RigSpec plug = parseRig(withCamera("power = \"plug\"\n[[power]]\nid = \"plug\"\n"
                                           "backend = \"serial\"\naddress = \"/dev/ttyUSB0\"\n"),
                                "rig.toml");
  EXPECT_EQ(plug.powers.at(0).address, "/dev/ttyUSB0");
  EXPECT_TRUE(plug.lights.empty());
  EXPECT_EQ(rig.cameras[0].call_limit, std::chrono::milliseconds(300));
  EXPECT_THAT(rig.triggers.at(0).cameras, ElementsAre("cam0"));
  EXPECT_THAT(rig.triggers.at(0).settings, ElementsAre(Pair("pulse_ms", "80")));
  EXPECT_THAT(errorOf(withCamera("power = \"plug\"\n")),
              HasSubstr("neither \"hub\" nor a [[power]]"));
  EXPECT_THAT(errorOf(withCamera("[[trigger]]\nid = \"line\"\nbackend = \"gpio\"\n"
                                 "cameras = [\"cam9\"]\n")),
              HasSubstr("fires \"cam9\""));
}

TEST(Rig, NeedsOnlyACamera) {
  const RigSpec rig = parseRig(withCamera(""), "/lab/kitchen.toml");
  EXPECT_EQ(rig.name, "kitchen");
  EXPECT_FALSE(rig.twin.has_value());
  EXPECT_THAT(errorOf("name = \"empty\"\n"), HasSubstr("at least one [[camera]]"));
}

TEST(Rig, ReadsTheFileItIsGiven) {
  const auto folder = patina::testing::TempFolder::inMemory();
  patina::testing::writeFile(folder / "rig.toml", kRig);
  EXPECT_EQ(readRig(folder / "rig.toml").twin->faults, folder / "faults/week.toml");
}

TEST(Rig, AnIdBelongsToOneDevice) {
  EXPECT_EQ(errorOf(withCamera("[[light]]\nid = \"cam0\"\nbackend = \"twin\"\n")),
            "rig.toml:5: light.id: \"cam0\" names two devices");
}

TEST(Rig, IdsCannotBreakFileNamesOrLightStates) {
  EXPECT_THAT(errorOf(withCamera("[[light]]\nid = \"a+b\"\nbackend = \"twin\"\n")),
              HasSubstr("rig.toml:5: light.id: \"a+b\" is no id"));
  EXPECT_THAT(errorOf(withCamera("[[light]]\nid = \"off\"\nbackend = \"twin\"\n")),
              HasSubstr("the dark state"));
  EXPECT_THAT(errorOf("[[camera]]\nid = \"rig\"\nbackend = \"twin\"\n"),
              HasSubstr("of its own in a faults file"));
  EXPECT_THAT(errorOf("[[camera]]\nid = \"../x\"\nbackend = \"twin\"\n"), HasSubstr("is no id"));
}

TEST(Rig, UnknownKeysAndChoicesNameTheNearest) {
  EXPECT_THAT(errorOf(withCamera("seriall = \"1\"\n")),
              AllOf(HasSubstr("rig.toml:4: camera.seriall"), HasSubstr("\"serial\"")));
  EXPECT_THAT(errorOf(withCamera("[[lights]]\nid = \"a\"\n")), HasSubstr("\"light\""));
  EXPECT_THAT(
      errorOf(withCamera("[[sensor]]\nid = \"s\"\nbackend = \"iio\"\nquantity = \"lux\"\n")),
      HasSubstr("one of illuminance, temperature, humidity"));
}

TEST(Rig, ABandIsOrderedAndHoldsItsBaseline) {
  const std::string sensor = "[[sensor]]\nid = \"s\"\nbackend = \"iio\"\nquantity = ";
  EXPECT_THAT(errorOf(withCamera(sensor + "\"humidity\"\nband = [60, 40]\n")),
              HasSubstr("low below high"));
  EXPECT_THAT(errorOf(withCamera(sensor + "\"illuminance\"\nband = [400, 600]\n")),
              HasSubstr("must hold 1"));
  EXPECT_EQ(errorOf(withCamera(sensor + "\"temperature\"\nband = [18, 24]\n")), "");
}

TEST(Rig, ThePatchLiesInThePictureOfACamera) {
  const auto patch = [](const std::string& text) {
    return errorOf(withCamera("[twin]\nsize = \"512x512\"\n[patch]\n" + text));
  };
  EXPECT_EQ(patch("rect_px = [448, 448, 64, 64]\n"), "");
  EXPECT_THAT(patch("rect_px = [449, 448, 64, 64]\n"), HasSubstr("beyond the picture (512x512)"));
  EXPECT_THAT(patch("rect_px = [-1, 0, 64, 64]\n"), HasSubstr("whole pixels"));
  EXPECT_THAT(patch("rect_px = [0.5, 0, 64, 64]\n"), HasSubstr("whole pixels"));
  EXPECT_THAT(patch("rect_px = [0, 0, 2, 64]\n"), HasSubstr("too small"));
  EXPECT_THAT(patch("rect_px = [1, 2, 64]\n"), HasSubstr("must be a list of 4 numbers"));
  EXPECT_THAT(patch("camera = \"cam1\"\nrect_px = [0, 0, 64, 64]\n"), HasSubstr("no camera"));
}

TEST(Rig, ACameraHasOnePatch) {
  const std::string patch = "[[patch]]\nrect_px = [0, 0, 64, 64]\n";
  EXPECT_THAT(errorOf(withCamera(patch + patch)), HasSubstr("has two patches"));
}

TEST(Rig, ATwinsSceneIsWhatItsTableSays) {
  const RigSpec rig = parseRig(withCamera("[twin]\nshadows = true\nsurroundings = \"daylight\"\n"
                                          "[[twin.target]]\nkind = \"charuco\"\nwidth_mm = 40\n"
                                          "columns = 7\nrows = 5\nposition_mm = [1, 2, 3]\n"
                                          "rotation_deg = [10, 0, 0]\n"
                                          "[[twin.target]]\nkind = \"mirror_sphere\"\n"),
                               "rig.toml");
  EXPECT_TRUE(rig.twin->shadows);
  EXPECT_EQ(rig.twin->surroundings, Surroundings::kDaylight);
  ASSERT_EQ(rig.twin->targets.size(), 2u);
  EXPECT_EQ(rig.twin->targets[0].kind, TargetSpec::kCharuco);
  EXPECT_EQ(rig.twin->targets[0].columns, 7);
  EXPECT_EQ(rig.twin->targets[0].position_mm[2], 3);
  EXPECT_EQ(rig.twin->targets[1].reflectance, 0.9);
}

TEST(Rig, ATargetHasNoKeysOfAnotherKindAndNoMoreMarkersThanThereAre) {
  const std::string target = "[twin]\n[[twin.target]]\nkind = ";
  EXPECT_THAT(errorOf(withCamera(target + "\"grey_card\"\ncolumns = 7\n")), HasSubstr("columns"));
  EXPECT_THAT(errorOf(withCamera(target + "\"mirror_sphere\"\nrotation_deg = [0, 0, 1]\n")),
              HasSubstr("rotation_deg"));
  EXPECT_THAT(errorOf(withCamera(target + "\"charuco\"\ncolumns = 12\nrows = 9\n")),
              HasSubstr("50 markers"));
  EXPECT_THAT(errorOf(withCamera(target + "\"teapot\"\n")), HasSubstr("grey_card"));
}

TEST(Rig, NumbersOutOfReasonAreRefused) {
  EXPECT_THAT(errorOf(withCamera("[twin]\nsize = \"100000x100000\"\n")), HasSubstr("16 to 16384"));
  EXPECT_THAT(errorOf(withCamera("[twin]\nsize = \"512\"\n")), HasSubstr("is not a size"));
  const std::string light = "[[light]]\nid = \"a\"\nbackend = \"twin\"\nposition_mm = ";
  EXPECT_THAT(errorOf(withCamera(light + "[0, 0, 1e9]\n")), HasSubstr("out of range"));
  EXPECT_THAT(errorOf(withCamera(light + "[0, 0, inf]\n")), HasSubstr("not finite"));
}

TEST(LightState, IsTheSortedIdsJoined) {
  EXPECT_EQ(lightStateName({"lamp", "key"}), "key+lamp");
  EXPECT_EQ(lightStateName({"key", "key"}), "key");
  EXPECT_EQ(lightStateName({}), "off");
}

TEST(LightState, GoesBothWays) {
  EXPECT_THAT(lightsOfState("off"), IsEmpty());
  EXPECT_THAT(lightsOfState("key+lamp"), ElementsAre("key", "lamp"));
  for (const char* state : {"off", "key", "a+b+c"}) {
    EXPECT_EQ(lightStateName(lightsOfState(state)), state);
  }
}

}  // namespace
}  // namespace patina::devices
