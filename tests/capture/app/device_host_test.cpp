// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "devices/host/dial.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

class DeviceHost : public ::testing::Test {
 protected:
  DeviceHost() {
    writeFile(key_, "0123456789abcdef0123456789abcdef\n");
    std::filesystem::permissions(key_, std::filesystem::perms(0600));
  }
  TempFolder files_ = TempFolder::inMemory();
  const std::string key_ = files_ / "pi.key";
};

TEST_F(DeviceHost, NeedsAPlaceToListenAndAKeyThatOthersCannotRead) {
  EXPECT_EQ(runPatina({"device-host"}).exit, 64);
  EXPECT_EQ(runPatina({"device-host", "--listen", "127.0.0.1:0"}).exit, 64);
  std::filesystem::permissions(key_, std::filesystem::perms(0644));
  const Finished open = runPatina({"device-host", "--listen", "127.0.0.1:0", "--key", key_});
  EXPECT_EQ(open.exit, 78);
  EXPECT_THAT(open.err, HasSubstr("chmod 600"));
}

// A port that was free a moment ago.
int freePort() { return devices::host::portOf(*devices::host::listenOn("127.0.0.1:0")); }

void awaitListening(const std::string& address) {
  devices::RealClock clock;
  const MonoTime until = clock.mono() + 10s;
  while (!devices::host::dial(address, clock.mono() + 1s) && clock.mono() < until)
    clock.sleepUntil(clock.mono() + 5ms, {});
}

TEST_F(DeviceHost, ServesARigThatHangsOnAnotherMachine) {
  const std::string address = "127.0.0.1:" + std::to_string(freePort());
  Child host({program(), "device-host", "--listen", address, "--key", key_});
  awaitListening(address);
  writeFile(files_ / "plan.toml",
            "rig = \"rig.toml\"\nspecimen = \"card\"\ninterval = \"1s\"\nduration = \"3s\"\n"
            "[[sweep]]\nlights = [[\"key\"]]\nexposures = [\"1/50\"]\n");
  writeFile(files_ / "rig.toml",
            "[[camera]]\nid = \"cam0\"\nbackend = \"twin\"\non = \"pi\"\n"
            "[[light]]\nid = \"key\"\nbackend = \"twin\"\non = \"pi\"\n"
            "[twin]\nsize = \"64x48\"\nspecimen = \"grey_card\"\nhosted = true\n"
            "[[host]]\nid = \"pi\"\naddress = \"" +
                address + "\"\nkey = \"pi.key\"\n");
  const std::string archive = files_ / "archive";
  const JsonAnswer answer =
      answerOf(runPatina({"capture", files_ / "plan.toml", "--archive", archive, "--json"}));
  EXPECT_GE(answer.number("/items/0/captured"), 2);  // a busy machine may be late for one
  EXPECT_EQ(runPatina({"archive", "verify", "--archive", archive}).exit, 0);
  host.signal(SIGTERM);
  const Finished ended = host.wait();
  EXPECT_EQ(ended.exit, 0);
  EXPECT_THAT(ended.err, HasSubstr("Serving this machine's devices"));
}

}  // namespace
}  // namespace patina::testing
