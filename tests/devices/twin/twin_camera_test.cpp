// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

#include "devices/config_file.h"
#include "processing/image/dng_file.h"
#include "tests/devices/twin/bench_rig.h"

namespace patina::devices::twin {
namespace {

using namespace std::chrono_literals;

TEST(TwinCamera, ItsDngOpensWithBlackWhiteAndExposureRight) {
  Bench bench(benchRig("banana_ripening", "64x48"));
  bench.light(0, 1);
  const auto frames = bench.shoot();
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].ext, "dng");
  const RawMosaic raw = decodeRaw(frames[0].bytes);
  EXPECT_EQ(raw.samples.size(), (SizePx{64, 48}));
  EXPECT_EQ(raw.black_level, 64);
  EXPECT_EQ(raw.white_level, 4095);
  EXPECT_EQ(raw.exposure, Nanoseconds(20ms));
  EXPECT_EQ(raw.cfa, (std::array<std::uint8_t, 4>{0, 1, 1, 2}));
}

TEST(TwinCamera, JpegAndRawAreTwoFilesOfOneShotAndShowTheSame) {
  RigSpec spec = benchRig("banana_ripening", "64x48");
  spec.cameras[0].settings["format"] = "raw+jpeg";
  Bench bench(spec);
  bench.light(0, 1);
  bench.advance(72h);
  const auto frames = bench.shoot();
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].ext, "jpg");
  EXPECT_EQ(frames[1].file_index, 1);
  const Picture raw = decodePicture(frames[0].bytes), jpeg = decodePicture(frames[1].bytes);
  double difference = 0, level = 0;
  for (std::size_t k = 0; k < raw.linear.texels().size(); ++k) {
    difference += std::abs(raw.linear.texels()[k] - jpeg.linear.texels()[k]);
    level += raw.linear.texels()[k];
  }
  EXPECT_LT(difference / level, 0.05);
}

TEST(TwinCamera, TheSameSeedGivesTheSameBytesForOneThreadAndForMore) {
  const RigSpec spec = benchRig("copper_patination", "256x256");
  Bench one(spec), two(spec);
  std::vector<RawFrame> serial;
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    one.light(1, 1);
    serial = one.shoot();
  }
  two.light(1, 1);
  EXPECT_EQ(serial[0].bytes, two.shoot()[0].bytes);
}

TEST(TwinCamera, ARestartedProcessTakesTheSamePictures) {
  RigSpec spec = benchRig("banana_ripening", "64x48");
  spec.lights[0].between = Between::kOn;
  TwinOptions options;
  options.start_utc = parseUtc("2024-05-01T12:00:00Z");
  Bench whole(spec, options), restarted(spec, options, 40h);
  whole.light(0, 1);
  whole.shoot();
  whole.clock.sleepUntil(whole.clock.mono() + (options.start_utc + 40h - whole.clock.utc()), {});
  restarted.light(0, 1);
  EXPECT_EQ(whole.shoot()[0].bytes, restarted.shoot()[0].bytes);
}

TEST(TwinCamera, TwoShotsOfOneSceneDifferByTheirNoise) {
  Bench bench(benchRig("grey_card", "64x48"));
  bench.light(0, 1);
  EXPECT_NE(bench.shoot()[0].bytes, bench.shoot()[0].bytes);
}

TEST(TwinCamera, ADeadLampGivesADarkPicture) {
  TwinOptions options;
  Fault dead;
  dead.at = 1h;
  dead.device = "key";
  dead.kind = FaultKind::kLampDead;
  dead.duration = 40min;
  options.faults.faults.push_back(dead);
  Bench bench(benchRig("grey_card", "64x48"), options);
  bench.light(0, 1);
  const auto mean = [](const RawMosaic& raw) {
    double sum = 0;
    for (const std::uint16_t v : raw.samples.texels()) sum += v - 64.0;
    return sum / static_cast<double>(raw.samples.texels().size());
  };
  const double lit = mean(decodeRaw(bench.shoot()[0].bytes));
  bench.advance(1h);
  EXPECT_LT(mean(decodeRaw(bench.shoot()[0].bytes)), 0.01 * lit);
}

TEST(TwinCamera, CollectTakesExposureAndReadoutOnTheClock) {
  Bench bench(benchRig("grey_card", "512x512"));
  const MonoTime before = bench.clock.mono();
  const auto frames = bench.shoot();
  EXPECT_EQ(bench.clock.mono() - before, Nanoseconds(170ms));
  EXPECT_EQ(frames[0].mono - before, Nanoseconds(10ms)) << "the middle of the exposure";
  EXPECT_EQ(frames[0].sequence, 1u);
}

TEST(TwinCamera, APictureThatIsNotReadyByTheDeadlineTimesOutAndStaysArmed) {
  Bench bench(benchRig("grey_card", "512x512"));
  const auto ticket = bench.camera().trigger({"slow", 9});
  const MonoTime deadline = bench.clock.mono() + 50ms;
  const auto early = bench.camera().collect(*ticket, deadline);
  ASSERT_FALSE(early);
  EXPECT_EQ(early.error().code, Errc::kTimeout);
  EXPECT_EQ(bench.clock.mono(), deadline);
  EXPECT_TRUE(bench.camera().collect(*ticket, bench.clock.mono() + 1s));
}

TEST(TwinCamera, CallsInAWrongStateAreRefusedAndChangeNothing) {
  VirtualClock clock(UtcTime{});
  Rig rig = makeTwinRig(benchRig("grey_card", "64x48"), {}, clock);
  Camera& camera = *rig.cameras[0];
  EXPECT_EQ(camera.trigger({"a", 1}).error().code, Errc::kRefused) << "closed";
  ASSERT_TRUE(camera.recover(Rung::kReopen));
  EXPECT_EQ(camera.collect({}, clock.mono()).error().code, Errc::kRefused) << "nothing armed";
  const auto ticket = camera.trigger({"a", 1});
  ASSERT_TRUE(ticket);
  EXPECT_EQ(camera.trigger({"b", 2}).error().code, Errc::kRefused) << "armed";
  EXPECT_EQ(camera.configure({}).error().code, Errc::kRefused);
  Ticket foreign = *ticket;
  foreign.key = "b";
  EXPECT_EQ(camera.collect(foreign, clock.mono() + 1s).error().code, Errc::kRefused);
  EXPECT_TRUE(camera.collect(*ticket, clock.mono() + 1s));
}

TEST(TwinCamera, RefusesWhatItCannotSetAndNeverAdjusts) {
  Bench bench(benchRig("grey_card", "64x48"));
  Exposure exposure;
  exposure.time = 60s;
  EXPECT_EQ(bench.camera().configure(exposure).error().code, Errc::kRefused);
  exposure.time = 40ms;
  exposure.iso = Iso{50};
  EXPECT_EQ(bench.camera().configure(exposure).error().code, Errc::kRefused);
  exposure.iso = Iso{400};
  const auto applied = bench.camera().configure(exposure);
  ASSERT_TRUE(applied);
  EXPECT_EQ(applied->exposure, exposure);
}

TEST(TwinCamera, CapsTellSizeFilesAndCycle) {
  RigSpec spec = benchRig("grey_card", "64x48");
  spec.cameras[0].settings = {{"format", "jpeg"}, {"width", "128"}, {"exposure_max", "1s"}};
  Bench bench(spec);
  const CameraCaps& caps = bench.camera().caps();
  EXPECT_EQ(caps.size, (SizePx{128, 48}));
  EXPECT_EQ(caps.bits, 8);
  EXPECT_EQ(caps.extensions, std::vector<std::string>{"jpg"});
  EXPECT_EQ(caps.exposure_max, Nanoseconds(1s));
  EXPECT_GE(caps.cycle, Nanoseconds(22ms));
}

}  // namespace
}  // namespace patina::devices::twin
