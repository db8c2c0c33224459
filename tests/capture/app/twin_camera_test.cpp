// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "devices/clock.h"
#include "processing/image/picture_file.h"
#include "tests/devices/twin/dslr/op_dmx_packet.h"
#include "tests/devices/twin/dslr/wire_client.h"
#include "tests/support/child.h"
#include "tests/support/places.h"

namespace patina::testing {
namespace {

using namespace devices::twin::dslr;
using ::testing::HasSubstr;
using ::testing::Not;

int freePort() { return portOf(listenAt("127.0.0.1", 0)); }

class TwinCamera : public ::testing::Test {
 protected:
  void begin(std::vector<std::string> arguments = {}) {
    std::vector<std::string> command = {program().string(), "twin",  "camera", "--ptpip",  place(),
                                        "--size",           "64x48", "--json", "--verbose"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    camera_ = std::make_unique<Child>(command);
  }
  std::string place() const { return "127.0.0.1:" + std::to_string(port_); }
  // Once it listens.
  std::unique_ptr<WireClient> client() {
    devices::RealClock clock;
    for (int i = 0; i < 2000; ++i) {
      auto client = std::make_unique<WireClient>(port_);
      if (client->is_open) return client;
      clock.sleepUntil(clock.mono() + std::chrono::milliseconds(10), {});
    }
    return nullptr;
  }
  Finished end() {
    camera_->signal(SIGINT);
    return camera_->wait();
  }

  int port_ = freePort();
  std::unique_ptr<Child> camera_;
};

TEST_F(TwinCamera, TakesPicturesOnTheWireUntilASignalEndsIt) {
  begin({"--serial", "77", "--model", "Patina Rig Camera"});
  const auto connection = client();
  ASSERT_TRUE(connection);
  EXPECT_EQ(connection->ask(Operation::kInitiateCapture), Answer::kOk);
  const std::uint32_t file = connection->nextFile();
  EXPECT_EQ(connection->ask(Operation::kGetObject, {file}), Answer::kOk);
  EXPECT_EQ(readPictureHeader(connection->data).size, (SizePx{64, 48}));
  const Finished finished = end();
  EXPECT_EQ(finished.exit, 0);
  EXPECT_THAT(finished.err, HasSubstr("Patina Rig Camera 77 listens at " + place()));
  EXPECT_THAT(finished.err, HasSubstr("gphoto2 --port ptpip:" + place()));
  EXPECT_THAT(finished.err, HasSubstr("picture 1: 1/100 f/8 ISO 100, lamps "));
  EXPECT_THAT(finished.err,
              Not(HasSubstr("lamps 0.000")));  // nobody is to switch them: they are on
  EXPECT_THAT(finished.out, HasSubstr("\"pictures\":1,"));
}

TEST_F(TwinCamera, HasLampsThatListenToArtNet) {
  const int artnet_port = portOf(bindUdp("127.0.0.1", 0));
  begin({"--artnet", std::to_string(artnet_port)});
  const auto connection = client();
  ASSERT_TRUE(connection);
  const auto brightness = [&] {
    EXPECT_EQ(connection->ask(Operation::kInitiateCapture), Answer::kOk);
    EXPECT_EQ(connection->ask(Operation::kGetObject, {connection->nextFile()}), Answer::kOk);
    const Picture picture = decodePicture(connection->data);
    double sum = 0;
    for (const float v : picture.linear.texels()) sum += v;
    return sum / static_cast<double>(picture.linear.texels().size());
  };
  const double dark = brightness();
  const Socket socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(artnet_port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const Bytes packet = opDmx(0, {0, 255});
  double lit = 0;  // once the packet is there
  for (int i = 0; i < 200 && !(lit > 10 * dark); ++i) {
    sendto(socket.fd(), packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to),
           sizeof to);
    lit = brightness();
  }
  EXPECT_GT(lit, 10 * dark);
  const Finished finished = end();
  EXPECT_THAT(finished.err, HasSubstr("lamps 0.000 0.000, PATN0001.JPG"));
  EXPECT_THAT(finished.err, HasSubstr("lamps 0.000 0.9"));
}

TEST_F(TwinCamera, MisbehavesAsItsFaultsFileSays) {
  const TempFolder folder = TempFolder::inMemory();
  writeFile(folder / "faults.toml",
            "[[fault]]\nat = '0s'\ndevice = 'cam0'\nkind = 'busy'\n"
            "[[fault]]\nat = '0s'\ndevice = 'key'\nkind = 'lamp_dead'\n");
  begin({"--faults", folder / "faults.toml"});
  const auto connection = client();
  ASSERT_TRUE(connection);
  EXPECT_EQ(connection->ask(Operation::kInitiateCapture), Answer::kDeviceBusy);
  EXPECT_EQ(connection->ask(Operation::kInitiateCapture), Answer::kOk);
  EXPECT_NE(connection->nextFile(), 0u);
  const Finished finished = end();
  EXPECT_THAT(finished.err, HasSubstr("lamps 0.000 0.9"));
  EXPECT_THAT(finished.out, HasSubstr("\"faults\":1,"));
}

TEST_F(TwinCamera, SaysWhatIsWrongWithItsOptions) {
  const TempFolder folder = TempFolder::inMemory();
  writeFile(folder / "faults.toml", "[[fault]]\nat = '0s'\ndevice = 'cam0'\nkind = 'sulk'\n");
  EXPECT_EQ(runPatina({"twin", "camera", "--ptpip", "127.0.0.1"}).exit, 64);
  EXPECT_EQ(runPatina({"twin", "camera", "--ptpip", "nowhere:0"}).exit, 64);
  EXPECT_EQ(runPatina({"twin", "camera", "--camera", "cam7"}).exit, 64);
  const Finished finished = runPatina({"twin", "camera", "--faults", folder / "faults.toml"});
  EXPECT_EQ(finished.exit, 78);
  EXPECT_THAT(finished.err, HasSubstr("faults.toml:"));
  const Socket taken = listenAt("127.0.0.1", port_);
  EXPECT_EQ(runPatina({"twin", "camera", "--ptpip", place()}).exit, 69);
}

}  // namespace
}  // namespace patina::testing
