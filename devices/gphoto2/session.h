// SPDX-License-Identifier: GPL-3.0-or-later
// libgphoto2, the whole of it that Patina uses: this is the one file that owns its handles. Nothing
// of it crosses this header. Not thread-safe; a call may take as long as the library's own timeout
// (2.5 s on a silent network camera, `normal_timeout` on USB), whatever deadline its caller has.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/gphoto2/choices.h"
#include "devices/result.h"
#include "processing/image/picture_file.h"

struct _CameraWidget;  // NOLINT(bugprone-reserved-identifier): the library's own name

namespace patina::devices::gphoto2 {

// Where a camera hangs: "usb:001,014" or "ptpip:HOST:PORT:PORT". No identity: it changes with every
// replugging.
struct Attached {
  std::string model;  // as the library calls it; "PTP/IP Camera" for every network camera
  std::string port;
};
std::vector<Attached> attachedOnUsb();
Attached networkCamera(const std::string& host, int port);
std::string libraryVersion();  // "2.5.30"

// One of the camera's own settings.
struct Setting {
  std::string value;
  Choices choices;  // empty: any text or number
  bool read_only = false;
};

struct CardFile {
  std::string folder, name;
  bool operator==(const CardFile&) const = default;
  std::string path() const { return folder + "/" + name; }
  std::string extension() const;  // "nef" "jpg": lower case, no dot
  std::string stem() const;       // of the name
};

struct LibraryEvent {
  enum Kind { kNothing, kFileAdded, kCaptureComplete, kOther };
  Kind kind = kNothing;
  CardFile file;     // of kFileAdded
  std::string text;  // of kOther, as the library has it
};

struct CardSpace {
  std::string label;
  std::uint64_t capacity_bytes = 0, free_bytes = 0;
  bool read_only = false;
};

// An open camera; closes itself. Errors carry the library's words and its code.
class Session {
 public:
  // `who` is the camera's name in messages. The library's cache of settings is switched off, or a
  // setting read back would be the one that was written.
  static Result<std::unique_ptr<Session>> open(const Attached& where, const std::string& who);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  const Attached& where() const;

  // kUnsupported: the camera has no such setting.
  Result<Setting> read(const std::string& setting);
  // Tells the camera; only read() tells whether it obeyed.
  Result<void> write(const std::string& setting, const std::string& value);
  // The camera's clock as it shows it, zone unknown, in whole seconds.
  Result<UtcTime> readClock();
  std::vector<std::string> settingNames();  // of the camera; empty when it cannot list them

  // Asks what any camera must answer: whether it still does.
  Result<void> probe();
  Result<void> trigger();
  // Network cameras answer at once with kNothing: whoever waits loops on a clock.
  Result<LibraryEvent> waitForEvent(Nanoseconds most);

  Result<std::vector<CardFile>> list(const std::string& folder);  // files alone
  Result<std::vector<std::string>> listFolders(const std::string& folder);
  void forgetListing();  // the next list() asks the camera
  Result<std::uint64_t> fileBytes(const CardFile& file);
  Result<Bytes> download(const CardFile& file, std::uint64_t bytes_most);
  Result<void> erase(const CardFile& file);  // ok when it is not there
  Result<std::vector<CardSpace>> cards();

  Result<void> resetPort();  // USB; kUnsupported on the network. The session is dead afterwards.

 private:
  struct Handles;
  using WidgetUse = std::function<Result<void>(_CameraWidget*)>;
  Result<void> fetch(const std::string& setting, const WidgetUse& use);
  explicit Session(std::unique_ptr<Handles> handles);
  std::unique_ptr<Handles> handles_;
};

}  // namespace patina::devices::gphoto2
