// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/network/camera_settings.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "devices/config_file.h"
#include "tests/support/temp_folder.h"

namespace patina::devices::network {
namespace {

using namespace std::chrono_literals;
using patina::testing::TempFolder;
using ::testing::HasSubstr;
using ::testing::Not;

class NetworkSettings : public ::testing::Test {
 protected:
  CameraSettings read(std::map<std::string, std::string> settings) {
    CameraSpec spec;
    spec.id = "cam0";
    spec.settings = std::move(settings);
    return readCameraSettings(spec, folder_ / "rig.toml");
  }
  std::string problemOf(std::map<std::string, std::string> settings) {
    settings.emplace("url", "http://camera/x.jpg");
    try {
      read(std::move(settings));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "none";
  }
  void secret(const std::string& text, std::filesystem::perms mode) {
    patina::testing::writeFile(folder_ / "cam0.secret", text);
    std::filesystem::permissions(folder_ / "cam0.secret", mode);
  }
  static constexpr auto kOwn =
      std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(NetworkSettings, AnAddressIsEnough) {
  const CameraSettings s = read({{"url", "https://camera.lab:8443/snapshot.jpg?q=1"}});
  EXPECT_FALSE(s.rtsp);
  EXPECT_EQ(s.ext, "jpg");
  EXPECT_EQ(s.latency, 1s);
  EXPECT_EQ(s.bytes_max, 32'000'000u);
  EXPECT_FALSE(s.fixed_exposure);
  EXPECT_TRUE(read({{"url", "rtsp://camera/live"}}).rtsp);
  EXPECT_EQ(read({{"url", "rtsp://camera/live"}}).ext, "png");
}

TEST_F(NetworkSettings, PasswordsComeFromAFileThatOnlyItsOwnerReads) {
  secret("rig:s3cret:with:colons\n", kOwn);
  EXPECT_EQ(read({{"url", "http://camera/"}, {"credentials", "cam0.secret"}}).credentials,
            "rig:s3cret:with:colons");
  secret("rig:s3cret\n", kOwn | std::filesystem::perms::group_read);
  EXPECT_THAT(problemOf({{"credentials", "cam0.secret"}}), HasSubstr("chmod 600"));
  secret("s3cret\n", kOwn);
  EXPECT_THAT(problemOf({{"credentials", "cam0.secret"}}), HasSubstr("user:password"));
  EXPECT_THAT(problemOf({{"credentials", "cam0.secret"}}), Not(HasSubstr("s3cret\"")));
  EXPECT_THAT(problemOf({{"credentials", "nowhere"}}), HasSubstr("cannot be read"));
}

TEST_F(NetworkSettings, MistakesNameTheKey) {
  for (const char* url : {"", "camera", "ftp://camera/x", "http:///x", "file:///etc/passwd"})
    EXPECT_THAT(problemOf({{"url", url}}), HasSubstr("settings.url")) << url;
  EXPECT_THAT(problemOf({{"url", "http://rig:pw@camera/x"}}),
              HasSubstr("must not hold a password"));
  EXPECT_THAT(problemOf({{"latency", "2min"}}), HasSubstr("latency"));
  EXPECT_THAT(problemOf({{"bytes_max", "big"}}), HasSubstr("bytes_max"));
  EXPECT_THAT(problemOf({{"iso", "100"}}), HasSubstr("unknown"));
}

TEST(HostOf, IsHostAndPortInSmallLetters) {
  EXPECT_EQ(hostOf("http://Camera.Lab:8080/x@y"), "camera.lab:8080");
  EXPECT_EQ(hostOf("http://user:pw@camera/x"), "camera");
  EXPECT_EQ(hostOf("http://camera?x=http://other/"), "camera");
  EXPECT_EQ(hostOf("camera/x"), "");
}

}  // namespace
}  // namespace patina::devices::network
