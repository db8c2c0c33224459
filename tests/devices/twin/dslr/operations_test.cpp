// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/operations.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/devices/twin/dslr/dslr_fixture.h"

namespace patina::devices::twin::dslr {
namespace {

using namespace std::chrono_literals;
class OperationsTest : public DslrTest {
 protected:
  Bytes answerOf(Operation operation, std::vector<std::uint32_t> parameters = {}) {
    return DslrClient::bytesOf(client_.ask(operation, std::move(parameters)));
  }
};

TEST_F(OperationsTest, NeverGivesADeletedPictureAgain) {
  std::set<std::uint32_t> deleted;
  for (int i = 0; i < 5; ++i) {
    shoot();
    const auto files = client_.files();
    ASSERT_EQ(files.size(), 1u);
    EXPECT_EQ(client_.ask(Operation::kDeleteObject, {files[0]}).answer, Answer::kOk);
    EXPECT_TRUE(deleted.insert(files[0]).second);
    for (const std::uint32_t gone : deleted)
      EXPECT_EQ(client_.ask(Operation::kGetObject, {gone}).answer, Answer::kInvalidObjectHandle);
  }
}

TEST_F(OperationsTest, GivesPartsOfAPicture) {
  shoot();
  const std::uint32_t file = client_.files().at(0);
  const Bytes whole = client_.download(file);
  const PtpReply part = client_.ask(Operation::kGetPartialObject, {file, 100, 50});
  EXPECT_EQ(DslrClient::bytesOf(part), Bytes(whole.begin() + 100, whole.begin() + 150));
  EXPECT_EQ(part.parameters, std::vector<std::uint32_t>{50});
  const auto end = static_cast<std::uint32_t>(whole.size());
  EXPECT_EQ(client_.ask(Operation::kGetPartialObject, {file, end - 3, 50}).bytes, 3u);
  EXPECT_EQ(client_.ask(Operation::kGetPartialObject, {file, end + 1, 1}).answer,
            Answer::kInvalidParameter);
}

TEST_F(OperationsTest, DoesNothingWithoutASession) {
  client_.ask(Operation::kCloseSession);
  EXPECT_EQ(trigger(), Answer::kSessionNotOpen);
  EXPECT_EQ(client_.ask(Operation::kGetDeviceInfo).answer, Answer::kOk);
  EXPECT_EQ(client_.ask(Operation::kOpenSession, {0}).answer, Answer::kInvalidParameter);
  EXPECT_EQ(client_.ask(Operation::kOpenSession, {5}).answer, Answer::kOk);
  EXPECT_EQ(client_.ask(Operation::kOpenSession, {6}).answer, Answer::kSessionAlreadyOpen);
  EXPECT_EQ(client_.ask(static_cast<Operation>(0x9801)).answer, Answer::kOperationNotSupported);
}

TEST_F(OperationsTest, TellsEqualModelsApartBySerialAndNoise) {
  Dslr other(world_, {.serial = "2002"});
  DslrClient client(other);
  shoot();
  EXPECT_EQ(client.ask(Operation::kInitiateCapture).answer, Answer::kOk);
  clock_.advance(1s);
  EXPECT_NE(client.download(client.files().at(0)), client_.download(client_.files().at(0)));
  EXPECT_NE(DslrClient::bytesOf(client.ask(Operation::kGetDeviceInfo)),
            DslrClient::bytesOf(client_.ask(Operation::kGetDeviceInfo)));
}

TEST_F(OperationsTest, NameBothStoresAndTheirRoom) {
  const Bytes ids = answerOf(Operation::kGetStorageIds);
  PtpReader from(ids);
  EXPECT_EQ(from.u32(), 2u);
  EXPECT_EQ(from.u32(), kCardStore);
  const Bytes info = answerOf(Operation::kGetStorageInfo, {kCardStore});
  PtpReader card(info);
  EXPECT_EQ(card.u16(), 4);  // removable
  card.u32();
  EXPECT_EQ(card.number(8), 32'000'000'000u);
  EXPECT_EQ(client_.ask(Operation::kGetStorageInfo, {7}).answer, Answer::kInvalidStorageId);
}

TEST_F(OperationsTest, DescribeAPictureAsItIs) {
  shoot();
  const std::uint32_t file = client_.files().at(0);
  const Bytes info = answerOf(Operation::kGetObjectInfo, {file});
  PtpReader from(info);
  EXPECT_EQ(from.u32(), kCardStore);
  EXPECT_EQ(from.u16(), static_cast<std::uint16_t>(ObjectFormat::kJpeg));
  from.u16();
  EXPECT_EQ(from.u32(), client_.download(file).size());
  from.raw(14);
  EXPECT_EQ(from.u32(), 64u);
  EXPECT_EQ(from.u32(), 48u);
  from.raw(18);
  EXPECT_EQ(from.text(), "PATN0001.JPG");
  EXPECT_EQ(from.text(), "20240501T120130");  // by its own clock
}

TEST_F(OperationsTest, RefuseHandlesStoresAndPropertiesThatAreNot) {
  EXPECT_EQ(client_.ask(Operation::kGetObjectInfo, {999}).answer, Answer::kInvalidObjectHandle);
  EXPECT_EQ(client_.ask(Operation::kDeleteObject, {999}).answer, Answer::kInvalidObjectHandle);
  EXPECT_EQ(client_.ask(Operation::kGetObjectHandles, {3, 0, 0}).answer, Answer::kInvalidStorageId);
  EXPECT_EQ(client_.ask(Operation::kGetObjectHandles, {kAllStores, 0, 999}).answer,
            Answer::kInvalidObjectHandle);
  EXPECT_EQ(client_.ask(Operation::kInitiateCapture, {3, 0}).answer, Answer::kInvalidStorageId);
  EXPECT_EQ(client_.ask(Operation::kGetDevicePropDesc, {0x5999}).answer,
            Answer::kDevicePropNotSupported);
  EXPECT_EQ(client_.ask(Operation::kGetThumb, {1}).answer, Answer::kNoThumbnail);
}

TEST_F(OperationsTest, SetAPropertyBackToWhatTheFactorySet) {
  EXPECT_EQ(client_.set(Property::kExposureIndex, 800, 2), Answer::kOk);
  const auto iso = static_cast<std::uint32_t>(Property::kExposureIndex);
  EXPECT_EQ(client_.ask(Operation::kResetDevicePropValue, {iso}).answer, Answer::kOk);
  EXPECT_EQ(client_.get(Property::kExposureIndex), 100);
  const auto count = static_cast<std::uint32_t>(Property::kShutterCount);
  EXPECT_EQ(client_.ask(Operation::kResetDevicePropValue, {count}).answer, Answer::kAccessDenied);
}

TEST_F(OperationsTest, DeleteEverythingAtOnce) {
  shoot();
  shoot();
  EXPECT_EQ(client_.ask(Operation::kGetNumObjects, {kAllStores, 0, 0}).parameters,
            std::vector<std::uint32_t>{4});  // and two folders
  EXPECT_EQ(client_.ask(Operation::kDeleteObject, {kAllStores}).answer, Answer::kOk);
  EXPECT_TRUE(client_.files().empty());
  for (const TruePicture& picture : camera_.truth().pictures)
    EXPECT_TRUE(picture.files.at(0).deleted_utc);
}

}  // namespace
}  // namespace patina::devices::twin::dslr
