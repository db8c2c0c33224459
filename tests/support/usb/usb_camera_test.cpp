// SPDX-License-Identifier: GPL-3.0-or-later
// The real libusb and libgphoto2 on the simulated device, in this process and in others.
#include "tests/support/usb/usb_camera.h"

#include <gphoto2/gphoto2.h>
#include <gtest/gtest.h>
#include <libusb.h>

#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/devices/twin/dslr/gphoto2_cli.h"

namespace patina::testing {
namespace {

using namespace devices::twin::dslr;
using namespace std::chrono_literals;

// A camera of libgphoto2 at a port, closed with the object.
class Client {
 public:
  explicit Client(const std::string& port) {
    CameraAbilitiesList* models = nullptr;
    gp_abilities_list_new(&models);
    gp_abilities_list_load(models, context_);
    CameraAbilities model;
    gp_abilities_list_get_abilities(
        models, gp_abilities_list_lookup_model(models, "USB PTP Class Camera"), &model);
    GPPortInfoList* ports = nullptr;
    gp_port_info_list_new(&ports);
    gp_port_info_list_load(ports);
    GPPortInfo info;
    gp_port_info_list_get_info(ports, gp_port_info_list_lookup_path(ports, port.c_str()), &info);
    gp_camera_new(&camera_);
    gp_camera_set_abilities(camera_, model);
    gp_camera_set_port_info(camera_, info);
    opened = gp_camera_init(camera_, context_);
    gp_port_info_list_free(ports);
    gp_abilities_list_free(models);
  }
  ~Client() {
    gp_camera_exit(camera_, context_);
    gp_camera_unref(camera_);
    gp_context_unref(context_);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  int trigger() { return gp_camera_trigger_capture(camera_, context_); }
  // Events until a file is there, at most `most` of them.
  std::string nextFile(int most = 50) {
    for (int i = 0; i < most; ++i) {
      CameraEventType type = GP_EVENT_UNKNOWN;
      void* data = nullptr;
      if (gp_camera_wait_for_event(camera_, 200, &type, &data, context_) < GP_OK) return {};
      const std::unique_ptr<void, decltype(&free)> owned(data, &free);
      if (type != GP_EVENT_FILE_ADDED) continue;
      const auto* const path = static_cast<const CameraFilePath*>(data);
      return std::string(path->folder) + "/" + path->name;
    }
    return {};
  }
  int get(const std::string& path, Bytes& into) {
    CameraFile* file = nullptr;
    gp_file_new(&file);
    const auto slash = path.rfind('/');
    const int result =
        gp_camera_file_get(camera_, path.substr(0, slash).c_str(), path.substr(slash + 1).c_str(),
                           GP_FILE_TYPE_NORMAL, file, context_);
    const char* data = nullptr;
    unsigned long bytes = 0;
    if (result >= GP_OK && gp_file_get_data_and_size(file, &data, &bytes) >= GP_OK)
      into.assign(reinterpret_cast<const std::byte*>(data),
                  reinterpret_cast<const std::byte*>(data) + bytes);
    gp_file_unref(file);
    return result;
  }
  void setPortTimeout(int ms) { gp_port_set_timeout(camera_->port, ms); }

  int opened = GP_ERROR;

 private:
  Camera* camera_ = nullptr;
  GPContext* context_ = gp_context_new();
};

class UsbCameraTest : public ::testing::Test {
 protected:
  Truth truth() const { return body_.truth(); }
  std::string shoot(Client& client) {
    EXPECT_EQ(client.trigger(), GP_OK);
    return client.nextFile();
  }

  devices::RealClock clock_;
  Dslr body_{dslrWorld(clock_), {}};
  UsbBus bus_;
  UsbCamera usb_{bus_, body_, 1};
};

TEST_F(UsbCameraTest, GivesItsPicturesToLibgphoto2ByteForByte) {
  Client client(usb_.gphotoPort());
  ASSERT_EQ(client.opened, GP_OK);
  const std::string path = shoot(client);
  EXPECT_EQ(path, "/store_00010001/DCIM/100PATNA/PATN0001.JPG");
  Bytes bytes;
  ASSERT_EQ(client.get(path, bytes), GP_OK);
  ASSERT_EQ(truth().pictures.size(), 1u);
  EXPECT_EQ(sha256(bytes), truth().pictures[0].files.at(0).hash);
}

TEST_F(UsbCameraTest, IsSilentAsLongAsItStallsAndAnswersANewClientAfterwards) {
  std::string path;
  Bytes bytes;
  {
    Client client(usb_.gphotoPort());
    path = shoot(client);
    client.setPortTimeout(50);
    body_.order({.kind = DslrFaultKind::kStall,
                 .operation = Operation::kGetObject,
                 .duration = 200ms,
                 .amount = 0.5});
    EXPECT_LT(client.get(path, bytes), GP_OK);
    EXPECT_LT(client.trigger(), GP_OK);
  }
  clock_.sleepUntil(clock_.mono() + 200ms, {});
  Client client(usb_.gphotoPort());
  ASSERT_EQ(client.opened, GP_OK);
  ASSERT_EQ(client.get(path, bytes), GP_OK);
  EXPECT_EQ(sha256(bytes), truth().pictures.at(0).files.at(0).hash);
}

TEST_F(UsbCameraTest, FailsEveryCallOnceItIsUnplugged) {
  Client client(usb_.gphotoPort());
  const std::string path = shoot(client);
  usb_.unplug();
  EXPECT_FALSE(usb_.isPluggedIn());
  Bytes bytes;
  EXPECT_LT(client.get(path, bytes), GP_OK);
  EXPECT_LT(client.trigger(), GP_OK);
  EXPECT_EQ(truth().pictures.size(), 1u);
}

TEST_F(UsbCameraTest, ComesBackUnderANewNumberWithItsCard) {
  const std::string first = usb_.gphotoPort();
  std::string path;
  {
    Client client(first);
    path = shoot(client);
    usb_.unplug();
  }
  usb_.plugIn(3);
  EXPECT_NE(usb_.gphotoPort(), first);
  Client client(usb_.gphotoPort());
  ASSERT_EQ(client.opened, GP_OK);
  Bytes bytes;
  ASSERT_EQ(client.get(path, bytes), GP_OK);
  EXPECT_EQ(sha256(bytes), truth().pictures.at(0).files.at(0).hash);
}

TEST_F(UsbCameraTest, IsAwayWhileItHasNoPower) {
  body_.turnOff(200ms);
  for (int i = 0; i < 1000 && usb_.isPluggedIn(); ++i) clock_.sleepUntil(clock_.mono() + 1ms, {});
  EXPECT_FALSE(usb_.isPluggedIn());
  for (int i = 0; i < 5000 && !usb_.isPluggedIn(); ++i) clock_.sleepUntil(clock_.mono() + 1ms, {});
  ASSERT_TRUE(usb_.isPluggedIn());
  EXPECT_EQ(Client(usb_.gphotoPort()).opened, GP_OK);
}

TEST_F(UsbCameraTest, IsReportedByUdevWhenItLeavesAndComes) {
  struct Seen {
    int arrived = 0, left = 0;
  } seen;
  libusb_context* usb = nullptr;
  ASSERT_EQ(libusb_init(&usb), 0);
  libusb_hotplug_register_callback(
      usb, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, 0, 0x1d6b,
      0x0100, LIBUSB_HOTPLUG_MATCH_ANY,
      [](libusb_context*, libusb_device*, libusb_hotplug_event event, void* to) {
        auto& counts = *static_cast<Seen*>(to);
        ++(event == LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED ? counts.arrived : counts.left);
        return 0;
      },
      &seen, nullptr);
  const auto untilSeen = [&](const int& count) {
    timeval patience{0, 100'000};
    for (int i = 0; i < 50 && count == 0; ++i)
      libusb_handle_events_timeout_completed(usb, &patience, nullptr);
  };
  usb_.unplug();
  untilSeen(seen.left);
  usb_.plugIn(2);
  untilSeen(seen.arrived);
  EXPECT_EQ(seen.left, 1);
  EXPECT_EQ(seen.arrived, 1);
  libusb_exit(usb);
}

TEST_F(UsbCameraTest, HasABrotherThatOnlyItsSerialTellsApart) {
  Dslr other(dslrWorld(clock_), {.serial = "2002"});
  UsbCamera second(bus_, other, 2);
  EXPECT_NE(second.gphotoPort(), usb_.gphotoPort());
  Client a(usb_.gphotoPort()), b(second.gphotoPort());
  ASSERT_EQ(a.opened, GP_OK);
  ASSERT_EQ(b.opened, GP_OK);
  Bytes bytes;
  ASSERT_EQ(b.get(shoot(b), bytes), GP_OK);
  EXPECT_EQ(sha256(bytes), other.truth().pictures.at(0).files.at(0).hash);
  EXPECT_TRUE(truth().pictures.empty());
}

TEST_F(UsbCameraTest, ServesTheCommandLineToo) {
  if (!Gphoto2Cli::isThere()) GTEST_SKIP() << "gphoto2 is not installed";
  Gphoto2Cli gphoto2(usb_.gphotoPort());
  const auto found = run({Gphoto2Cli::kProgram, "--auto-detect"});
  EXPECT_NE(found.out.find("USB PTP Class Camera           " + usb_.gphotoPort()),
            std::string::npos)
      << found.out << found.err;
  EXPECT_NE(gphoto2({"--summary"}).out.find("Serial Number: 1001"), std::string::npos);
  const auto bad = gphoto2({"--set-config-value", "iso=123"});
  EXPECT_NE(bad.exit, 0);
  const auto file = gphoto2.folder / "shot.jpg";
  const auto done = gphoto2({"--set-config-value", "shutterspeed=1/50",
                             "--capture-image-and-download", "--filename", file.string()});
  ASSERT_EQ(done.exit, 0) << done.err;
  EXPECT_EQ(sha256OfFile(file), truth().pictures.at(0).files.at(0).hash);
  EXPECT_EQ(truth().pictures[0].exposure.time, 20ms);
  EXPECT_TRUE(truth().pictures[0].files[0].deleted_utc);
}

}  // namespace
}  // namespace patina::testing
