// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/devices/usb/mock_node.h"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <umockdev.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>

namespace patina::testing {

struct MockNode::Bed {
  UMockdevTestbed* testbed = nullptr;
  UMockdevIoctlBase* handler = nullptr;
  std::string node;
  MockAnswer answer;
  std::vector<UMockdevIoctlClient*> unanswered;

  ~Bed() {
    for (UMockdevIoctlClient* client : unanswered) {
      umockdev_ioctl_client_complete(client, -1, ENODEV);
      g_object_unref(client);
    }
    GError* error = nullptr;
    umockdev_testbed_detach_ioctl(testbed, node.c_str(), &error);
    g_clear_error(&error);
    g_object_unref(handler);
    g_object_unref(testbed);
  }
};

namespace {

struct Argument {
  UMockdevIoctlData* data = nullptr;  // the library's
  std::vector<std::uint8_t> bytes, setup;
};

std::vector<std::uint8_t> bytesOf(UMockdevIoctlData* data, std::size_t length) {
  return {data->data, data->data + length};
}

Argument argumentOf(UMockdevIoctlClient* client, unsigned long request) {
  Argument argument;
  UMockdevIoctlData* arg = umockdev_ioctl_client_get_arg(client);
  if (request == USBDEVFS_CONTROL) {
    UMockdevIoctlData* transfer =
        umockdev_ioctl_data_resolve(arg, 0, sizeof(usbdevfs_ctrltransfer), nullptr);
    usbdevfs_ctrltransfer t{};
    std::memcpy(&t, transfer->data, sizeof t);
    argument.setup = bytesOf(transfer, 8);
    if (t.wLength == 0) return argument;
    argument.data = umockdev_ioctl_data_resolve(transfer, offsetof(usbdevfs_ctrltransfer, data),
                                                t.wLength, nullptr);
    argument.bytes = bytesOf(argument.data, t.wLength);
  } else if (const auto size = _IOC_SIZE(request); _IOC_TYPE(request) == 'H' && size > 0) {
    argument.data = umockdev_ioctl_data_resolve(arg, 0, size, nullptr);
    argument.bytes = bytesOf(argument.data, size);
  }
  return argument;
}

gboolean onIoctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer bed_pointer) {
  auto* bed = static_cast<MockNode::Bed*>(bed_pointer);
  const unsigned long request =
      static_cast<std::uint32_t>(umockdev_ioctl_client_get_request(client));
  Argument argument = argumentOf(client, request);
  const int result = bed->answer({request, argument.setup, argument.bytes});
  if (result == kNeverAnswer) {
    bed->unanswered.push_back(UMOCKDEV_IOCTL_CLIENT(g_object_ref(client)));
    return TRUE;
  }
  if (argument.data != nullptr)
    umockdev_ioctl_data_update(argument.data, 0, argument.bytes.data(),
                               static_cast<gint>(argument.bytes.size()));
  umockdev_ioctl_client_complete(client, result < 0 ? -1 : result, result < 0 ? -result : 0);
  return TRUE;
}

std::unique_ptr<MockNode::Bed> makeBed(const std::string& description, std::string node,
                                       MockAnswer answer) {
  auto bed = std::make_unique<MockNode::Bed>();
  bed->testbed = umockdev_testbed_new();
  bed->handler = umockdev_ioctl_base_new();
  bed->node = std::move(node);
  bed->answer = std::move(answer);
  g_signal_connect(bed->handler, "handle-ioctl", G_CALLBACK(onIoctl), bed.get());
  GError* error = nullptr;
  if (!umockdev_testbed_add_from_string(bed->testbed, description.c_str(), &error) ||
      !umockdev_testbed_attach_ioctl(bed->testbed, bed->node.c_str(), bed->handler, &error))
    throw std::runtime_error(error->message);
  return bed;
}

}  // namespace

bool underUmockdev() { return umockdev_in_mock_environment(); }

MockNode::MockNode(std::unique_ptr<Bed> bed) : bed_(std::move(bed)) {}
MockNode::MockNode(MockNode&&) noexcept = default;
MockNode::~MockNode() = default;

MockNode MockNode::usb(MockAnswer answer) {
  return MockNode(
      makeBed("P: /devices/pci0/usb1/1-1\nN: bus/usb/001/002\n"
              "E: DEVNAME=/dev/bus/usb/001/002\nE: DEVTYPE=usb_device\n"
              "E: SUBSYSTEM=usb\nA: busnum=1\nA: devnum=2\nA: idVendor=05e3\n"
              "A: idProduct=0610\nA: bDeviceClass=09\nA: product=USB2.0 Hub\n"
              "A: speed=480\n",
              "/dev/bus/usb/001/002", std::move(answer)));
}

MockNode MockNode::hidraw(MockAnswer answer) {
  return MockNode(
      makeBed("P: /devices/pci0/usb1/1-2/1-2:1.0/0003:16C0:05DF.0001/hidraw/hidraw0\n"
              "N: hidraw0\nE: DEVNAME=/dev/hidraw0\nE: SUBSYSTEM=hidraw\n",
              "/dev/hidraw0", std::move(answer)));
}

}  // namespace patina::testing
