// SPDX-License-Identifier: GPL-3.0-or-later
// What others make of our packets: Wireshark's dissectors, and OLA's daemon as a receiver.
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <sstream>

#include "devices/dmx/dmx.h"
#include "devices/dmx/packets.h"
#include "tests/support/child.h"
#include "tests/support/temp_folder.h"

namespace patina::devices::dmx {
namespace {

using namespace std::chrono_literals;
using patina::testing::Child;
using patina::testing::Finished;
using patina::testing::TempFolder;
using ::testing::HasSubstr;

using Packet = std::vector<std::uint8_t>;

bool installed(const std::string& tool) { return std::filesystem::exists("/usr/bin/" + tool); }

void put(std::string& out, std::uint64_t v, int bytes) {  // little-endian
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(v >> (8 * i));
}
void putBig(std::string& out, std::uint64_t v, int bytes) {
  for (int i = bytes - 1; i >= 0; --i) out += static_cast<char>(v >> (8 * i));
}

// A capture of UDP datagrams over IPv4, without a link layer.
std::string captureOf(const std::vector<std::pair<int, Packet>>& datagrams) {
  std::string pcap;
  put(pcap, 0xa1b2c3d4, 4);
  put(pcap, 2, 2);
  put(pcap, 4, 2);
  put(pcap, 0, 8);
  put(pcap, 65535, 4);
  put(pcap, 101, 4);  // LINKTYPE_RAW
  for (const auto& [port, payload] : datagrams) {
    const std::size_t length = payload.size() + 28;
    put(pcap, 0, 8);
    put(pcap, length, 4);
    put(pcap, length, 4);
    putBig(pcap, 0x4500, 2);
    putBig(pcap, length, 2);
    putBig(pcap, 0, 4);
    putBig(pcap, 0x4011, 2);  // UDP
    putBig(pcap, 0, 2);
    putBig(pcap, 0x0a000001, 4);
    putBig(pcap, 0x0a000002, 4);
    putBig(pcap, static_cast<std::uint64_t>(port), 2);
    putBig(pcap, static_cast<std::uint64_t>(port), 2);
    putBig(pcap, payload.size() + 8, 2);
    putBig(pcap, 0, 2);
    pcap.append(payload.begin(), payload.end());
  }
  return pcap;
}

// One line a datagram, the fields between tabs.
std::string dissected(const std::vector<std::pair<int, Packet>>& datagrams,
                      const std::vector<std::string>& fields) {
  const TempFolder folder;
  patina::testing::writeFile(folder / "x.pcap", captureOf(datagrams));
  std::vector<std::string> command{"/usr/bin/tshark",     "-r",  (folder / "x.pcap").string(),
                                   "--enable-heuristic",  "acn", "-o",
                                   "acn.dmx_enable:TRUE", "-T",  "fields"};
  for (const std::string& field : fields) command.insert(command.end(), {"-e", field});
  const Finished done = patina::testing::run(command, {"HOME=" + folder.path().string()});
  EXPECT_EQ(done.exit, 0) << done.err;
  return done.out;
}

Slots levels() {
  Slots slots{};
  slots[0] = 10;
  slots[1] = 20;
  slots[511] = 255;
  return slots;
}

TEST(Wireshark, ReadsOurArtNetAsItWasMeant) {
  if (!installed("tshark")) GTEST_SKIP() << "tshark is not installed";
  EXPECT_EQ(dissected({{kArtNetPort, artDmx(0x1234, 7, levels())}},
                      {"artnet.header.opcode", "artnet.header.protver", "artnet.output.sequence",
                       "artnet.output.universe", "artnet.output.length", "_ws.malformed"}),
            "0x5000\t14\t7\t4660\t512\t\n");
}

TEST(Wireshark, ReadsOurSacnAsItWasMeant) {
  if (!installed("tshark")) GTEST_SKIP() << "tshark is not installed";
  SacnSource source;
  for (std::size_t i = 0; i < 16; ++i) source.cid[i] = static_cast<std::uint8_t>(i + 1);
  source.name = "Patina";
  source.priority = 120;
  EXPECT_EQ(dissected({{kSacnPort, sacnData(source, 7962, 9, levels())},
                       {kSacnPort, sacnTerminated(source, 7962, 10, levels())}},
                      {"acn.cid", "acn.dmx.source_name", "acn.dmx.priority", "acn.dmx.seq_number",
                       "acn.dmx.option_s", "acn.dmx.universe", "acn.dmx.start_code2",
                       "acn.dmx.count", "_ws.malformed"}),
            "01020304-0506-0708-090a-0b0c0d0e0f10\tPatina\t120\t9\t0\t7962\t0\t513\t\n"
            "01020304-0506-0708-090a-0b0c0d0e0f10\tPatina\t120\t10\t1\t7962\t0\t513\t\n");
}

// olad with its Art-Net and E1.31 inputs and nothing else; never as root.
class Ola : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* tool : {"olad", "ola_patch", "ola_dev_info", "ola_recorder"})
      if (!installed(tool)) GTEST_SKIP() << tool << " is not installed (package ola)";
    for (const char* plugin :
         {"dummy",    "espnet",  "ftdidmx",          "gpio",    "karate",   "kinet",    "milinst",
          "nanoleaf", "opendmx", "openpixelcontrol", "osc",     "pathport", "renard",   "sandnet",
          "shownet",  "spi",     "stageprofi",       "uartdmx", "usbdmx",   "usbserial"})
      patina::testing::writeFile(folder_ / ("ola-" + std::string(plugin) + ".conf"),
                                 "enabled = false\n");
    std::filesystem::permissions(folder_.path(), std::filesystem::perms::all);
    // Its log is thrown away at the lowest level: without avahi it would fill the disk.
    std::vector<std::string> command{"/usr/bin/olad",
                                     "--config-dir",
                                     folder_.path().string(),
                                     "--no-http",
                                     "--no-register-with-dns-sd",
                                     "-l",
                                     "0"};
    if (getuid() == 0) {
      const std::vector<std::string> as_nobody{"/usr/bin/setpriv", "--reuid=nobody",
                                               "--regid=nogroup", "--clear-groups"};
      command.insert(command.begin(), as_nobody.begin(), as_nobody.end());
    }
    daemon_ = std::make_unique<Child>(command);
    ASSERT_TRUE(answers()) << "olad does not answer on its port 9010";
  }
  bool answers() {
    for (int i = 0; i < 100; ++i) {
      const Finished info = patina::testing::run({"/usr/bin/ola_dev_info"});
      devices_ = info.out;
      if (info.exit == 0 && devices_.find("E1.31") != std::string::npos) return true;
      clock_.sleepUntil(clock_.mono() + 100ms, {});
    }
    return false;
  }
  // "Device 1: ArtNet [192.0.2.2]": its number and the address it listens on.
  std::pair<std::string, std::string> deviceNamed(const std::string& name) const {
    std::istringstream lines(devices_);
    for (std::string line; std::getline(lines, line);) {
      if (line.find(name) == std::string::npos || !line.starts_with("Device ")) continue;
      const auto open = line.rfind('['), close = line.rfind(']');
      return {line.substr(7, line.find(':') - 7), line.substr(open + 1, close - open - 1)};
    }
    return {};
  }
  // What OLA shows of universe 1 while `backend` lights channels 1 and 3.
  std::string received(const std::string& backend, const std::string& device_name) {
    const auto [number, address] = deviceNamed(device_name);
    const Finished patched =
        patina::testing::run({"/usr/bin/ola_patch", "-i", "-d", number, "-p", "0", "-u", "1"});
    EXPECT_EQ(patched.exit, 0) << patched.err;
    LightSpec spec;
    spec.id = "key";
    spec.backend = backend;
    spec.address = address;
    spec.settings = {{"universe", "1"}, {"channels", "1,3"}, {"full", "0.5"}};
    const auto light = makeLight(spec, "rig.toml", clock_);
    EXPECT_TRUE(light->recover());
    EXPECT_TRUE(light->set(1));
    const auto show = folder_ / "show";
    Child recorder({"/usr/bin/ola_recorder", "-r", show.string(), "-u", "1"});
    std::string text;
    for (int i = 0; i < 100 && text.find("\n1 128") == std::string::npos; ++i) {
      clock_.sleepUntil(clock_.mono() + 100ms, {});  // it takes the next packet that comes
      if (std::filesystem::exists(show)) text = patina::testing::readFile(show);
    }
    recorder.signal(SIGINT);
    recorder.wait();
    return patina::testing::readFile(show);
  }
  RealClock clock_;
  TempFolder folder_ = TempFolder::inMemory();
  std::string devices_;
  std::unique_ptr<Child> daemon_;
};

TEST_F(Ola, ReceivesOurArtNet) {
  EXPECT_THAT(received("artnet", "ArtNet"), HasSubstr("\n1 128,0,128,0,"));
}

TEST_F(Ola, ReceivesOurSacn) {
  EXPECT_THAT(received("sacn", "E1.31"), HasSubstr("\n1 128,0,128,0,"));
}

}  // namespace
}  // namespace patina::devices::dmx
