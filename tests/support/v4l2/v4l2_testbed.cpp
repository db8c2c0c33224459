// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/v4l2/v4l2_testbed.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <umockdev.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace patina::testing {
namespace {

namespace fs = std::filesystem;

struct FreeError {
  void operator()(GError* error) const { g_error_free(error); }
};
using Error = std::unique_ptr<GError, FreeError>;

[[noreturn]] void fail(GError* error) {
  const Error owned(error);
  throw std::runtime_error(std::string("umockdev: ") + (error ? error->message : "?"));
}

// On umockdev's own thread, while the caller waits in its ioctl.
gboolean onIoctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user) {
  auto& camera = *static_cast<SimulatedCamera*>(user);
  // The upper half is a sign extension that the kernel drops too.
  const unsigned long request = static_cast<guint32>(umockdev_ioctl_client_get_request(client));
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  UMockdevIoctlData* data = nullptr;
  if (const auto size = _IOC_SIZE(request); size > 0)
    data = umockdev_ioctl_data_resolve(argument, 0, size, nullptr);
  const int error = data ? camera.call(request, data->data) : ENOTTY;
  umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
  if (data) umockdev_ioctl_data_unref(data);
  return TRUE;
}

}  // namespace

// umockdev's own question answers "no" before the first testbed is there.
bool underUmockdev() {
  const char* preloaded = std::getenv("LD_PRELOAD");
  return preloaded && std::strstr(preloaded, "umockdev") != nullptr;
}

struct V4l2Testbed::State {
  struct Plugged {
    SimulatedCamera* camera;
    UMockdevIoctlBase* handler;
    int file;
    std::string node;             // "video0"
    std::vector<fs::path> paths;  // to take away when it is pulled out
  };
  UMockdevTestbed* testbed = umockdev_testbed_new();
  fs::path root = [this] {
    gchar* folder = umockdev_testbed_get_root_dir(testbed);
    fs::path path = folder;
    g_free(folder);
    return path;
  }();
  std::vector<Plugged> plugged;

  void remove(Plugged& one) {
    one.camera->pullOut();
    umockdev_testbed_detach_ioctl(testbed, ("/dev/" + one.node).c_str(), nullptr);
    std::error_code ignored;
    for (const fs::path& path : one.paths) fs::remove_all(path, ignored);
    close(one.file);
    g_object_unref(one.handler);
  }
};

V4l2Testbed::V4l2Testbed() : state_(std::make_unique<State>()) {}

V4l2Testbed::~V4l2Testbed() {
  for (State::Plugged& one : state_->plugged) state_->remove(one);
  g_object_unref(state_->testbed);
}

std::string V4l2Testbed::byId(const SimulatedCamera& camera) {
  return "/dev/v4l/by-id/usb-" + camera.serial + "-video-index0";
}

std::string V4l2Testbed::byPath(int port) {
  return "/dev/v4l/by-path/pci-usb-0:" + std::to_string(port) + ":1.0-video-index0";
}

void V4l2Testbed::plugIn(SimulatedCamera& camera, int number, int port) {
  const std::string node = "video" + std::to_string(number);
  const std::string usb = "/devices/usb1/1-" + std::to_string(port);
  const std::string interface = usb + "/1-" + std::to_string(port) + ":1.0";
  std::string text = "P: " + usb + "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\n";
  if (!camera.serial.empty()) text += "A: serial=" + camera.serial + "\n";
  text += "\nP: " + interface + "/video4linux/" + node + "\nN: " + node + "=00\nE: DEVNAME=/dev/" +
          node + "\nE: SUBSYSTEM=video4linux\nA: dev=81:" + std::to_string(number) +
          "\nA: name=" + camera.model + "\nA: index=0\n";
  GError* error = nullptr;
  if (!umockdev_testbed_add_from_string(state_->testbed, text.c_str(), &error)) fail(error);

  State::Plugged one{&camera, umockdev_ioctl_base_new(), -1, node, {}};
  g_signal_connect(one.handler, "handle-ioctl", G_CALLBACK(onIoctl), &camera);
  if (!umockdev_testbed_attach_ioctl(state_->testbed, ("/dev/" + node).c_str(), one.handler,
                                     &error))
    fail(error);
  const fs::path& root = state_->root;
  one.file = open((root / "dev" / node).c_str(), O_RDWR | O_CLOEXEC);
  one.paths = {root / "sys" / usb.substr(1),
               root / "sys/class/video4linux" / node,
               root / "sys/bus/usb/devices" / fs::path(usb).filename(),
               root / "dev" / node,
               root / "dev/.node" / node,
               root / "sys/dev/char" / ("81:" + std::to_string(number))};
  const auto link = [&](const std::string& name) {
    const fs::path path = root / name.substr(1);
    fs::create_directories(path.parent_path());
    if (fs::is_symlink(path)) return;  // as udev: the first keeps it
    fs::create_symlink("../../" + node, path);
    one.paths.push_back(path);
  };
  if (!camera.serial.empty()) link(byId(camera));
  link(byPath(port));
  camera.attachTo(one.file);
  camera.plugIn();
  state_->plugged.push_back(std::move(one));
}

void V4l2Testbed::pullOut(SimulatedCamera& camera) {
  std::erase_if(state_->plugged, [&](State::Plugged& one) {
    if (one.camera != &camera) return false;
    state_->remove(one);
    return true;
  });
}

}  // namespace patina::testing
