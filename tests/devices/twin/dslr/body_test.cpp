// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/body.h"

#include <gtest/gtest.h>

#include <set>

#include "processing/image/metadata_file.h"
#include "processing/image/sha256.h"
#include "tests/devices/twin/dslr/dslr_fixture.h"

namespace patina::devices::twin::dslr {
namespace {

using namespace std::chrono_literals;
using BodyTest = DslrTest;

TEST_F(BodyTest, SaysWhenAPictureIsThereAndNotBefore) {
  client_.set(Property::kExposureTime, 10'000, 4);  // 1 s
  EXPECT_EQ(trigger(), Answer::kOk);
  const auto due = camera_.nextDue();
  EXPECT_EQ(due, clock_.mono() + 1020ms);
  clock_.advance(1019ms);
  EXPECT_TRUE(camera_.takeEvents().empty());
  EXPECT_TRUE(client_.files().empty());
  clock_.advance(1ms);
  const auto events = camera_.takeEvents();
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[0].code, EventCode::kObjectAdded);
  EXPECT_EQ(events[0].parameters, client_.files());
  EXPECT_EQ(events[1].code, EventCode::kCaptureComplete);
}

TEST_F(BodyTest, TakesAPairOfRawAndJpegThatSayTheSame) {
  client_.set(Property::kCompression, kRawAndJpeg, 1);
  client_.set(Property::kExposureTime, 200, 4);
  client_.set(Property::kFNumber, 560, 2);
  client_.set(Property::kExposureIndex, 400, 2);
  EXPECT_EQ(count(shoot(), EventCode::kObjectAdded), 2);
  const auto files = client_.files();
  ASSERT_EQ(files.size(), 2u);
  EXPECT_EQ(client_.nameOf(files[0]), "PATN0001.DNG");
  EXPECT_EQ(client_.nameOf(files[1]), "PATN0001.JPG");
  for (const std::uint32_t handle : files) {
    const Bytes file = client_.download(handle);
    const PictureMetadata said = readMetadata(file);
    // The camera's clock, which is 90 s ahead, in steps of 10 ms.
    EXPECT_EQ(said.taken_utc, parseUtc("2024-05-01T12:01:30.12Z"));
    EXPECT_EQ(said.exposure, 20ms);
    EXPECT_EQ(said.iso, Iso{400});
    EXPECT_EQ(said.f_number, FNumber{5.6});
    EXPECT_EQ(said.camera, "Patina DSLR");
    EXPECT_EQ(readPictureHeader(file).size, (SizePx{64, 48}));
  }
}

TEST_F(BodyTest, LogsWhatWasTakenAndWhatWasDeleted) {
  world_->setLamp(0, 1);
  shoot();
  const auto files = client_.files();
  ASSERT_EQ(files.size(), 1u);
  const Sha256 hash = sha256(client_.download(files[0]));
  EXPECT_EQ(client_.ask(Operation::kDeleteObject, {files[0]}).answer, Answer::kOk);
  const Truth truth = camera_.truth();
  ASSERT_EQ(truth.pictures.size(), 1u);
  const TruePicture& picture = truth.pictures[0];
  EXPECT_EQ(picture.count, 1u);
  EXPECT_EQ(picture.begin_utc, parseUtc("2024-05-01T12:00:00.123Z"));
  EXPECT_EQ(picture.exposure, (Exposure{10ms, Iso{100}, FNumber{8}}));
  EXPECT_GT(picture.levels.at(0), 0.9);
  EXPECT_EQ(picture.levels.at(1), 0);
  ASSERT_EQ(picture.files.size(), 1u);
  EXPECT_EQ(picture.files[0].handle, files[0]);
  EXPECT_EQ(picture.files[0].hash, hash);
  EXPECT_TRUE(picture.files[0].deleted_utc);
  EXPECT_EQ(client_.get(Property::kShutterCount), 1);
}

TEST_F(BodyTest, IsBrighterUnderALampThanInTheDark) {
  const auto mean = [&] {
    shoot();
    const Picture picture = decodePicture(client_.download(client_.files().back()));
    double sum = 0;
    for (const float v : picture.linear.texels()) sum += v;
    return sum / static_cast<double>(picture.linear.texels().size());
  };
  const double dark = mean();
  world_->setLamp(0, 1);
  EXPECT_GT(mean(), 10 * dark);
}

TEST_F(BodyTest, SaysNothingOfAPictureToAClientThatComesLater) {
  EXPECT_EQ(trigger(), Answer::kOk);
  client_.ask(Operation::kCloseSession);
  clock_.advance(1s);
  EXPECT_TRUE(camera_.takeEvents().empty());
  client_.ask(Operation::kOpenSession, {1});
  EXPECT_TRUE(camera_.takeEvents().empty());
  EXPECT_EQ(client_.files().size(), 1u);
}

TEST_F(BodyTest, AnswersBusyWhileItExposes) {
  EXPECT_EQ(trigger(), Answer::kOk);
  EXPECT_EQ(trigger(), Answer::kDeviceBusy);
  EXPECT_FALSE(camera_.pressShutter());
  clock_.advance(1s);
  EXPECT_EQ(trigger(), Answer::kOk);
}

TEST_F(BodyTest, HasAClockThatCanBeReadAndSet) {
  PtpWriter text;
  text.text("20240501T130000.0");
  EXPECT_EQ(client_
                .ask(Operation::kSetDevicePropValue,
                     {static_cast<std::uint32_t>(Property::kDateTime)}, text.take())
                .answer,
            Answer::kOk);
  clock_.advance(1500ms);
  const Bytes bytes = DslrClient::bytesOf(client_.ask(
      Operation::kGetDevicePropValue, {static_cast<std::uint32_t>(Property::kDateTime)}));
  EXPECT_EQ(PtpReader(bytes).text(), "20240501T130001.5");
}

TEST_F(BodyTest, RefusesANewPictureOnAFullCard) {
  Dslr small(world_, {.card_bytes = 30'000});
  DslrClient client(small);
  for (int i = 0; i < 100; ++i) {
    if (client.ask(Operation::kInitiateCapture).answer == Answer::kStoreFull) break;
    clock_.advance(1s);
  }
  EXPECT_EQ(client.ask(Operation::kInitiateCapture).answer, Answer::kStoreFull);
  EXPECT_EQ(client.ask(Operation::kFormatStore, {kCardStore}).answer, Answer::kOk);
  EXPECT_EQ(client.ask(Operation::kInitiateCapture).answer, Answer::kOk);
}

TEST_F(BodyTest, ChoosesItsExposureInAnAutomaticMode) {
  client_.set(Property::kExposureProgram, kProgram, 2);
  std::set<Nanoseconds> times;
  for (int i = 0; i < 20; ++i) shoot();
  for (const TruePicture& picture : camera_.truth().pictures) times.insert(picture.exposure.time);
  EXPECT_GT(times.size(), 1u);
}

TEST_F(BodyTest, LosesSessionAndMemoryWithItsPowerButNotItsCard) {
  shoot();
  client_.set(Property::kSaveTo, kToMemory, 1);
  shoot();
  EXPECT_EQ(client_.files().size(), 2u);
  camera_.turnOff(3s);
  EXPECT_FALSE(camera_.isOn());
  EXPECT_TRUE(client_.ask(Operation::kGetDeviceInfo).trouble);
  EXPECT_FALSE(camera_.pressShutter());
  clock_.advance(3s);
  camera_.takeEvents();
  EXPECT_TRUE(camera_.isOn());
  EXPECT_EQ(client_.ask(Operation::kGetStorageIds).answer, Answer::kSessionNotOpen);
  client_.ask(Operation::kOpenSession, {1});
  EXPECT_EQ(client_.files().size(), 1u);
  const Truth truth = camera_.truth();
  EXPECT_FALSE(truth.pictures.at(0).files.at(0).lost);
  EXPECT_TRUE(truth.pictures.at(1).files.at(0).lost);
  EXPECT_EQ(truth.power_losses, 1u);
}

TEST_F(BodyTest, LosesThePictureItIsTakingWithItsPower) {
  EXPECT_EQ(trigger(), Answer::kOk);
  camera_.order({.kind = DslrFaultKind::kPowerLoss, .duration = 1s, .at = 5ms});
  EXPECT_EQ(camera_.nextDue(), clock_.mono() + 5ms);
  clock_.advance(5s);
  camera_.takeEvents();
  clock_.advance(5s);
  EXPECT_TRUE(camera_.takeEvents().empty());
  EXPECT_TRUE(camera_.truth().pictures.empty());
}

}  // namespace
}  // namespace patina::devices::twin::dslr
