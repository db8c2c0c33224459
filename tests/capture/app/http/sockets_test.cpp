// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/sockets.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/capture/app/http/wire.h"
#include "tests/support/temp_folder.h"

namespace patina::http {
namespace {

Exit exitOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const HttpError& error) {
    return error.exit();
  }
  return Exit::kOk;
}

TEST(ListenOnUnix, IsOpenToOwnerAndGroupAlone) {
  const auto folder = testing::TempFolder::inMemory();
  const devices::Descriptor listener = listenOnUnix(folder / "s", getegid());
  struct stat facts {};
  ASSERT_EQ(stat((folder / "s").c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0660u);
}

TEST(ListenOnUnix, TakesOverASocketOfADeadDaemonAndNotOfALivingOne) {
  const auto folder = testing::TempFolder::inMemory();
  { const devices::Descriptor dead = listenOnUnix(folder / "s", {}); }
  const devices::Descriptor living = listenOnUnix(folder / "s", {});
  EXPECT_EQ(exitOf([&] { listenOnUnix(folder / "s", {}); }), Exit::kTemporary);
}

TEST(ListenOnUnix, RemovesNothingThatIsNoSocket) {
  const auto folder = testing::TempFolder::inMemory();
  testing::writeFile(folder / "s", "precious");
  EXPECT_EQ(exitOf([&] { listenOnUnix(folder / "s", {}); }), Exit::kCannotCreate);
  EXPECT_EQ(testing::readFile(folder / "s"), "precious");
}

TEST(ListenOnUnix, SaysThatAPathIsTooLong) {
  EXPECT_EQ(exitOf([] { listenOnUnix("/" + std::string(120, 'x'), {}); }), Exit::kConfig);
}

TEST(ListenOnTcp, RefusesANameAndAPortThatIsTaken) {
  const devices::Descriptor listener = listenOnTcp("127.0.0.1", 0);
  EXPECT_GT(portOf(listener), 0);
  EXPECT_EQ(exitOf([&] { listenOnTcp("127.0.0.1", portOf(listener)); }), Exit::kUnavailable);
  EXPECT_EQ(exitOf([] { listenOnTcp("localhost", 0); }), Exit::kConfig);
  EXPECT_EQ(exitOf([] { listenOnTcp("127.0.0.1", 65536); }), Exit::kConfig);
}

TEST(IsLoopback, KnowsTheLoopbackOfBothFamiliesAndNoName) {
  for (const char* address : {"127.0.0.1", "127.9.9.9", "::1"})
    EXPECT_TRUE(isLoopback(address)) << address;
  for (const char* address :
       {"0.0.0.0", "::", "192.168.1.2", "128.0.0.1", "localhost", "", "127.0.0.1.evil"})
    EXPECT_FALSE(isLoopback(address)) << address;
}

TEST(CheckExposure, WantsATokenAndAPrivateLineOutsideTheLoopback) {
  const auto exit = [](const char* listen, bool token, bool tls, bool proxy) {
    return exitOf([&] { checkExposure(listen, token, tls, proxy); });
  };
  EXPECT_EQ(exit("127.0.0.1", false, false, false), Exit::kOk);
  EXPECT_EQ(exit("0.0.0.0", false, false, false), Exit::kConfig);
  EXPECT_EQ(exit("0.0.0.0", true, false, false), Exit::kConfig);
  EXPECT_EQ(exit("0.0.0.0", false, true, true), Exit::kConfig);
  EXPECT_EQ(exit("0.0.0.0", true, true, false), Exit::kOk);
  EXPECT_EQ(exit("0.0.0.0", true, false, true), Exit::kOk);
}

TEST(RoleOfPeer, IsAdminForOurOwnUser) {
  const auto folder = testing::TempFolder::inMemory();
  const devices::Descriptor listener = listenOnUnix(folder / "s", {});
  const Wire client = Wire::local(folder / "s");
  const devices::Descriptor accepted(accept(listener.fd(), nullptr, nullptr));
  EXPECT_EQ(roleOfPeer(accepted.fd(), Role::kPublic), Role::kAdmin);
  EXPECT_EQ(peerName(accepted.fd()), "unix");
}

TEST(RoleOfPeer, IsWhatOthersAreForAnotherUser) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  const auto folder = testing::TempFolder::inMemory();
  const devices::Descriptor listener = listenOnUnix(folder / "s", {});
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  ASSERT_EQ(chmod((folder / "s").c_str(), 0777), 0);
  ASSERT_EQ(seteuid(65534), 0);  // the credentials of the moment of connect() count
  const Wire client = Wire::local(folder / "s");
  ASSERT_EQ(seteuid(0), 0);
  const devices::Descriptor accepted(accept(listener.fd(), nullptr, nullptr));
  EXPECT_EQ(roleOfPeer(accepted.fd(), Role::kPublic), Role::kPublic);
  EXPECT_EQ(roleOfPeer(accepted.fd(), Role::kViewer), Role::kViewer);
}

TEST(PeerName, IsTheAddressWithoutThePort) {
  const devices::Descriptor listener = listenOnTcp("127.0.0.1", 0);
  const Wire client = Wire::tcp(portOf(listener), "127.0.0.9");
  const devices::Descriptor accepted(accept(listener.fd(), nullptr, nullptr));
  EXPECT_EQ(peerName(accepted.fd()), "127.0.0.9");
}

}  // namespace
}  // namespace patina::http
