// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/guest/usb_gadget.h"

#include <fcntl.h>
#include <linux/usb/functionfs.h>
#include <pthread.h>
#include <sys/mount.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace patina::testing {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr const char* kConfigFs = "/sys/kernel/config";
constexpr const char* kController = "dummy_udc.0";

[[noreturn]] void broken(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

void put(const std::string& file, const std::string& text) {
  std::ofstream out(file);
  out << text << "\n" << std::flush;
  if (!out) broken(file);
}

std::string hex(std::uint16_t v) {
  char text[8];
  std::snprintf(text, sizeof text, "0x%04x", v);
  return text;
}

template <class T>
void append(Bytes& to, const T& value) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&value);
  to.insert(to.end(), bytes, bytes + sizeof value);
}

// A signal that does nothing ends a blocked read.
void letSignalsInterrupt() {
  struct sigaction action {};
  action.sa_handler = [](int) {};
  ::sigaction(SIGUSR1, &action, nullptr);
}

}  // namespace

UsbGadget::UsbGadget(const GadgetIdentity& who, const Bytes& interface, int endpoints,
                     OnSetup on_setup, devices::Clock& clock)
    : gadget_(std::string(kConfigFs) + "/usb_gadget/" + who.name),
      function_(gadget_ + "/functions/ffs." + who.name),
      mount_("/run/" + who.name),
      on_setup_(std::move(on_setup)),
      clock_(clock) {
  letSignalsInterrupt();
  makeFolders(who);
  if (::mount(who.name.c_str(), mount_.c_str(), "functionfs", 0, nullptr) != 0) broken(mount_);
  control_ = ::open((mount_ + "/ep0").c_str(), O_RDWR | O_CLOEXEC);
  if (control_ < 0) broken("ep0");
  describe(interface);
  for (int i = 1; i <= endpoints; ++i) {
    endpoints_.push_back(::open((mount_ + "/ep" + std::to_string(i)).c_str(), O_RDWR | O_CLOEXEC));
    if (endpoints_.back() < 0) broken("endpoint " + std::to_string(i));
  }
  serve([this] { serveControl(); });
}

UsbGadget::~UsbGadget() {
  try {
    unplug();
  } catch (const std::exception&) {
    // It was never plugged in.
  }
  stopping_ = true;
  while (running_ > 0) {
    for (std::thread& thread : threads_) ::pthread_kill(thread.native_handle(), SIGUSR1);
    clock_.sleepUntil(clock_.mono() + 5ms, {});
  }
  for (std::thread& thread : threads_) thread.join();
  for (const int fd : endpoints_) ::close(fd);
  ::close(control_);
  ::umount(mount_.c_str());
  removeFolders();
}

void UsbGadget::makeFolders(const GadgetIdentity& who) {
  fs::create_directories(gadget_ + "/strings/0x409");
  put(gadget_ + "/idVendor", hex(who.vendor));
  put(gadget_ + "/idProduct", hex(who.product));
  put(gadget_ + "/strings/0x409/manufacturer", who.manufacturer);
  put(gadget_ + "/strings/0x409/product", who.model);
  put(gadget_ + "/strings/0x409/serialnumber", who.serial);
  fs::create_directories(gadget_ + "/configs/c.1");
  fs::create_directories(function_);
  fs::create_directory_symlink(function_, gadget_ + "/configs/c.1/function");
  fs::create_directories(mount_);
}

void UsbGadget::removeFolders() {
  std::error_code ignored;
  fs::remove(gadget_ + "/configs/c.1/function", ignored);
  fs::remove(gadget_ + "/configs/c.1", ignored);
  fs::remove(gadget_ + "/strings/0x409", ignored);
  fs::remove(function_, ignored);
  fs::remove(gadget_, ignored);
  fs::remove(mount_, ignored);
}

void UsbGadget::describe(const Bytes& interface) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < interface.size(); i += std::to_integer<std::size_t>(interface[i]))
    ++count;
  Bytes descriptors;
  usb_functionfs_descs_head_v2 head{FUNCTIONFS_DESCRIPTORS_MAGIC_V2, 0, FUNCTIONFS_HAS_HS_DESC};
  head.length = static_cast<std::uint32_t>(sizeof head + sizeof count + interface.size());
  append(descriptors, head);
  append(descriptors, count);
  descriptors.insert(descriptors.end(), interface.begin(), interface.end());
  if (::write(control_, descriptors.data(), descriptors.size()) < 0) broken("descriptors");
  const usb_functionfs_strings_head none{FUNCTIONFS_STRINGS_MAGIC, sizeof none, 0, 0};
  if (::write(control_, &none, sizeof none) < 0) broken("strings");
}

void UsbGadget::plugIn() { put(gadget_ + "/UDC", kController); }

void UsbGadget::unplug() { put(gadget_ + "/UDC", ""); }

void UsbGadget::onDisable(std::function<void()> call) {
  const std::lock_guard lock(mutex_);
  on_disable_ = std::move(call);
}

void UsbGadget::serve(std::function<void()> again) {
  ++running_;
  threads_.emplace_back([this, again = std::move(again)] {
    while (!stopping_) again();
    --running_;
  });
}

void UsbGadget::serveControl() {
  usb_functionfs_event event{};
  if (::read(control_, &event, sizeof event) != sizeof event) return;
  if (event.type == FUNCTIONFS_SETUP) {
    std::array<std::byte, 8> setup{};
    std::memcpy(setup.data(), &event.u.setup, setup.size());
    answer(setup);
  } else if (event.type == FUNCTIONFS_DISABLE) {
    const std::lock_guard lock(mutex_);
    if (on_disable_) on_disable_();
  }
}

// FunctionFS stalls a request whose data is moved the wrong way.
void UsbGadget::answer(std::span<const std::byte, 8> setup) {
  const auto at = [&](std::size_t i) { return std::to_integer<std::size_t>(setup[i]); };
  const bool to_host = (at(0) & 0x80) != 0;
  const std::size_t length = at(6) | at(7) << 8;
  Bytes data(to_host ? 0 : length);
  [[maybe_unused]] ssize_t moved = 0;
  if (!to_host) moved = ::read(control_, data.data(), data.size());  // acknowledges it, too
  const auto reply = on_setup_(setup, data);
  if (!to_host) return;
  if (reply)
    moved = ::write(control_, reply->data(), std::min(length, reply->size()));
  else
    moved = ::read(control_, nullptr, 0);
}

}  // namespace patina::testing
