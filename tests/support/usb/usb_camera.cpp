// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/usb/usb_camera.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <umockdev.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <thread>
#include <vector>

#include "devices/twin/dslr/due_signal.h"
#include "processing/image/failure.h"
#include "tests/support/usb/urb_queue.h"
#include "tests/support/usb/usb_descriptors.h"
#include "tests/support/usb/usb_ptp.h"

namespace patina::testing {
namespace {

using devices::twin::dslr::Dslr;
using devices::twin::dslr::DueSignal;

// A program that looks for a finished request too early waits this long for its "none": the node is
// always ready for poll(), and libusb would ask without pause.
constexpr Nanoseconds kReapPatience = std::chrono::milliseconds(1);
// After a reset connection the camera comes back by itself.
constexpr Nanoseconds kUnpluggedFor = std::chrono::milliseconds(50);

constexpr const char* kHost =
    "P: /devices/pci0000:00/0000:00:14.0/usb1\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\n"
    "E: BUSNUM=001\nE: DEVNUM=001\nA: busnum=1\\n\nA: devnum=1\\n\nA: speed=480\\n\n"
    "A: bConfigurationValue=1\\n\nA: devpath=0\\n\n"
    "H: descriptors=12010002090001406B1D020000060302010109021900010100E0000904000001090000000705"
    "810304000C\n";

void insist(GError* error) {
  if (error == nullptr) return;
  const std::string what = error->message;
  g_error_free(error);
  throw Failure(Exit::kUnavailable, "umockdev: " + what);
}

}  // namespace

struct UsbBus::State {
  std::mutex mutex;  // guards all
  GObjectPointer<UMockdevTestbed> bed{umockdev_testbed_new()};
  int next_number = 2;
};

UsbBus::UsbBus() : state_(std::make_unique<State>()) {
  if (!isThere())
    throw Failure(Exit::kUnavailable, "a simulated USB bus is there under umockdev-wrapper alone");
  GError* error = nullptr;
  umockdev_testbed_add_from_string(state_->bed.get(), kHost, &error);
  insist(error);
}
UsbBus::~UsbBus() = default;

bool UsbBus::isThere() {
  const char* const preload = std::getenv("LD_PRELOAD");
  return preload != nullptr && std::strstr(preload, "umockdev") != nullptr;
}

class UsbCamera::Impl {
 public:
  Impl(UsbBus::State& bus, Dslr& camera, int port)
      : bus_(bus), camera_(camera), ptp_(camera), due_(camera.clock()) {
    who_.name = camera.options().model;
    who_.serial = camera.options().serial;
    plugIn(port);
    camera_.onChange([this] { due_.wake(); });
    thread_ = std::thread([this] { run(); });
  }
  ~Impl() {
    camera_.onChange({});
    stop_ = true;
    due_.wake();
    thread_.join();
    unplug();
  }

  void unplug();
  void plugIn(int port);
  bool isPluggedIn() const {
    const std::lock_guard lock(mutex_);
    return plug_ != nullptr;
  }
  int resets() const {
    const std::lock_guard lock(mutex_);
    return resets_;
  }
  int number() const {
    const std::lock_guard lock(mutex_);
    return number_;
  }

 private:
  // From plugging in to pulling out: programs that have the node open keep what they had.
  struct Plug {
    explicit Plug(Impl& impl) : owner(impl) {}
    Impl& owner;
    GObjectPointer<UMockdevIoctlBase> handler{umockdev_ioctl_base_new()};
    UrbQueue urbs;
    bool gone = false;
  };

  static gboolean onIoctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer plug) {
    static_cast<Plug*>(plug)->owner.handle(*static_cast<Plug*>(plug), client);
    return TRUE;
  }
  void run();
  void handle(Plug& plug, UMockdevIoctlClient* client);
  int answerAtOnce(Plug& plug, UMockdevIoctlClient* client, gulong request);
  void serve();
  void followTheCamera();
  std::optional<UrbQueue::Outcome> answer(const Urb& urb);
  std::optional<UrbQueue::Outcome> control(const Urb& urb);

  UsbBus::State& bus_;
  Dslr& camera_;
  UsbIdentity who_;

  mutable std::mutex mutex_;  // guards what follows, to the signal
  UsbPtp ptp_;
  std::vector<std::unique_ptr<Plug>> plugs_;  // all there were
  Plug* plug_ = nullptr;                      // none: unplugged
  std::string path_;                          // in /sys
  int port_ = 0, number_ = 0, resets_ = 0;
  std::optional<MonoTime> back_at_;  // it comes back by itself
  DueSignal due_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

void UsbCamera::Impl::plugIn(int port) {
  const std::scoped_lock lock(bus_.mutex, mutex_);
  if (plug_ != nullptr) return;
  port_ = port;
  number_ = bus_.next_number++;
  back_at_.reset();
  const std::string name = "1-" + std::to_string(port);
  path_ = "/sys/devices/pci0000:00/0000:00:14.0/usb1/" + name;
  plugs_.push_back(std::make_unique<Plug>(*this));
  plug_ = plugs_.back().get();
  GError* error = nullptr;
  umockdev_testbed_add_from_string(bus_.bed.get(), usbDevice(who_, name, number_).c_str(), &error);
  insist(error);
  char node[32];
  std::snprintf(node, sizeof node, "/dev/bus/usb/001/%03d", number_);
  g_signal_connect(plug_->handler.get(), "handle-ioctl", G_CALLBACK(&Impl::onIoctl), plug_);
  umockdev_testbed_attach_ioctl(bus_.bed.get(), node, plug_->handler.get(), &error);
  insist(error);
  umockdev_testbed_uevent(bus_.bed.get(), path_.c_str(), "add");
}

void UsbCamera::Impl::unplug() {
  const std::scoped_lock lock(bus_.mutex, mutex_);
  if (plug_ == nullptr) return;
  plug_->gone = true;
  plug_->urbs.failAll(-ESHUTDOWN);
  plug_->urbs.answerReapers(camera_.clock().mono(), true);
  plug_ = nullptr;
  ptp_.reset();
  umockdev_testbed_uevent(bus_.bed.get(), path_.c_str(), "remove");
  umockdev_testbed_remove_device(bus_.bed.get(), path_.c_str());
}

void UsbCamera::Impl::run() {
  while (!stop_) {
    pollfd fd{due_.fd(), POLLIN, 0};
    while (poll(&fd, 1, -1) < 0) continue;  // EINTR
    due_.clear();
    followTheCamera();
    const std::lock_guard lock(mutex_);
    serve();
  }
}

// Without power, and after a reset connection, the camera is not on the bus.
void UsbCamera::Impl::followTheCamera() {
  bool leave = false, come = false;
  {
    const std::lock_guard lock(mutex_);
    ptp_.takeEvents();
    const MonoTime now = camera_.clock().mono();
    leave = plug_ != nullptr && (ptp_.wantsUnplug() || !camera_.isOn());
    if (leave) back_at_ = now + kUnpluggedFor;
    come = !leave && back_at_ && *back_at_ <= now && camera_.isOn();
  }
  if (leave) unplug();
  if (come) plugIn(port_);
}

void UsbCamera::Impl::serve() {
  ptp_.takeEvents();
  std::optional<MonoTime> next = ptp_.nextDue();
  const auto sooner = [&](std::optional<MonoTime> other) {
    if (other && (!next || *other < *next)) next = other;
  };
  for (const auto& plug : plugs_) {
    if (plug.get() == plug_) plug->urbs.answer([this](const Urb& urb) { return answer(urb); });
    plug->urbs.answerReapers(camera_.clock().mono(), plug->gone);
    sooner(plug->urbs.nextDue());
  }
  if (back_at_ && camera_.isOn()) sooner(back_at_);
  if (ptp_.wantsUnplug()) due_.wake();
  due_.arm(next);
}

void UsbCamera::Impl::handle(Plug& plug, UMockdevIoctlClient* client) {
  const std::lock_guard lock(mutex_);
  const gulong request = umockdev_ioctl_client_get_request(client);
  if (request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY) {
    plug.urbs.reap(client, request == USBDEVFS_REAPURB ? MonoTime::max()
                                                       : camera_.clock().mono() + kReapPatience);
  } else {
    const int error = plug.gone ? ENODEV : answerAtOnce(plug, client, request);
    umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
  }
  serve();
}

int UsbCamera::Impl::answerAtOnce(Plug& plug, UMockdevIoctlClient* client, gulong request) {
  UMockdevIoctlData* const argument = umockdev_ioctl_client_get_arg(client);
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* const out =
          umockdev_ioctl_data_resolve(argument, 0, sizeof(std::uint32_t), nullptr);
      const std::uint32_t can = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      if (out == nullptr) return EFAULT;
      std::memcpy(out->data, &can, sizeof can);
      return 0;
    }
    case USBDEVFS_SUBMITURB:
      return plug.urbs.submit(client, argument);
    case USBDEVFS_DISCARDURB:
      return plug.urbs.discard(client, argument);
    case USBDEVFS_RESET:
      ++resets_;
      plug.urbs.failAll(-EPROTO);
      ptp_.reset();
      return 0;
    case USBDEVFS_GETDRIVER:
      return ENODATA;  // nobody's
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_RELEASEINTERFACE:
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_DISCONNECT_CLAIM:
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_RESETEP:
      return 0;
    default:
      return ENOTTY;
  }
}

std::optional<UrbQueue::Outcome> UsbCamera::Impl::answer(const Urb& urb) {
  if (urb.head().type == USBDEVFS_URB_TYPE_CONTROL) return control(urb);
  const std::span<std::byte> bytes = urb.bytes();
  std::optional<UsbTransfer> transfer;
  switch (urb.head().endpoint) {
    case kBulkOut:
      transfer = ptp_.bulkOut(bytes);
      break;
    case kBulkIn:
      transfer = ptp_.bulkIn(bytes.size());
      break;
    case kInterruptIn:
      transfer = ptp_.interruptIn(bytes.size());
      break;
    default:
      return UrbQueue::Outcome{-ENOENT, 0};
  }
  if (!transfer || transfer->kind == UsbTransfer::kGone) return std::nullopt;
  if (transfer->kind == UsbTransfer::kStalledPipe) return UrbQueue::Outcome{-EPIPE, 0};
  if (urb.head().endpoint == kBulkOut) return UrbQueue::Outcome{0, bytes.size()};
  std::ranges::copy(transfer->bytes, bytes.begin());
  return UrbQueue::Outcome{0, transfer->bytes.size()};
}

std::optional<UrbQueue::Outcome> UsbCamera::Impl::control(const Urb& urb) {
  constexpr std::size_t kSetupBytes = 8;
  const std::span<std::byte> bytes = urb.bytes();
  if (bytes.size() < kSetupBytes) return UrbQueue::Outcome{-EINVAL, 0};
  const auto setup = bytes.first(kSetupBytes);
  UsbTransfer transfer;
  if (const auto text = textDescriptor(who_, setup))
    transfer.bytes = *text;
  else
    transfer = ptp_.control(setup, bytes.subspan(kSetupBytes));
  if (transfer.kind != UsbTransfer::kDone) return UrbQueue::Outcome{-EPIPE, 0};
  const std::size_t length = std::min(transfer.bytes.size(), bytes.size() - kSetupBytes);
  std::copy_n(transfer.bytes.begin(), length, bytes.begin() + kSetupBytes);
  return UrbQueue::Outcome{0, length};
}

UsbCamera::UsbCamera(UsbBus& bus, Dslr& camera, int port)
    : impl_(std::make_unique<Impl>(*bus.state_, camera, port)) {}
UsbCamera::~UsbCamera() = default;

void UsbCamera::unplug() { impl_->unplug(); }
void UsbCamera::plugIn(int port) { impl_->plugIn(port); }
bool UsbCamera::isPluggedIn() const { return impl_->isPluggedIn(); }
int UsbCamera::resets() const { return impl_->resets(); }

std::string UsbCamera::gphotoPort() const {
  char text[16];
  std::snprintf(text, sizeof text, "usb:001,%03d", impl_->number());
  return text;
}

std::string UsbCamera::node() const {
  char text[32];
  std::snprintf(text, sizeof text, "/dev/bus/usb/001/%03d", impl_->number());
  return text;
}

}  // namespace patina::testing
