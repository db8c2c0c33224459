// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/session.h"

#include <gphoto2/gphoto2-version.h>
#include <gphoto2/gphoto2.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <set>

#include "devices/gphoto2/descriptor_care.h"
#include "devices/gphoto2/widget.h"

namespace patina::devices::gphoto2 {

namespace {

struct Freed {
  void operator()(Camera* p) const { gp_camera_unref(p); }
  void operator()(GPContext* p) const { gp_context_unref(p); }
  void operator()(CameraAbilitiesList* p) const { gp_abilities_list_free(p); }
  void operator()(GPPortInfoList* p) const { gp_port_info_list_free(p); }
  void operator()(CameraList* p) const { gp_list_free(p); }
  void operator()(CameraFile* p) const { gp_file_unref(p); }
  void operator()(CameraWidget* p) const { gp_widget_unref(p); }
};
struct MallocFreed {
  void operator()(void* p) const { std::free(p); }
};
template <class T>
using Owned = std::unique_ptr<T, Freed>;

template <class T, class... Args>
Owned<T> made(int (*make)(T**, Args...), Args... args) {
  T* raw = nullptr;
  make(&raw, args...);
  return Owned<T>(raw);
}

std::string firstLine(std::string text) {
  text.resize(std::min(text.find('\n'), text.size()));
  return text;
}

// One call may complain twice: the first words are those of the camera.
void keepErrors(GPContext*, const char* text, void* all) {
  auto& said = *static_cast<std::string*>(all);
  if (text && said.size() < 300) said += (said.empty() ? "" : "; ") + firstLine(text);
}

// The camera models the library knows: 40 ms to load, and the same for the life of the process.
CameraAbilitiesList* models() {
  static const Owned<CameraAbilitiesList> kModels = [] {
    auto list = made(gp_abilities_list_new);
    const Owned<GPContext> context(gp_context_new());
    gp_abilities_list_load(list.get(), context.get());
    return list;
  }();
  return kModels.get();
}

// New each time: it holds what is plugged in now.
Owned<GPPortInfoList> portsNow() {
  auto ports = made(gp_port_info_list_new);
  gp_port_info_list_load(ports.get());
  return ports;
}

Errc meaningOf(int code) {
  switch (code) {
    case GP_ERROR_CAMERA_BUSY:
    case GP_ERROR_IO_USB_CLAIM:
    case GP_ERROR_IO_LOCK:
      return Errc::kBusy;
    case GP_ERROR_TIMEOUT:
      return Errc::kTimeout;
    case GP_ERROR_NOT_SUPPORTED:
    case GP_ERROR_UNKNOWN_PORT:
    case GP_ERROR_MODEL_NOT_FOUND:
      return Errc::kUnsupported;
    case GP_ERROR_BAD_PARAMETERS:
    case GP_ERROR_NO_SPACE:
    case GP_ERROR_DIRECTORY_NOT_FOUND:
    case GP_ERROR_FILE_NOT_FOUND:
      return Errc::kRefused;
    case GP_ERROR:  // an answer nobody has a word for, or none: probe() tells
    case GP_ERROR_CORRUPTED_DATA:
    case GP_ERROR_FIXED_LIMIT_EXCEEDED:
      return Errc::kCorrupt;
    default:
      return Errc::kLost;
  }
}

std::vector<std::string> namesOf(CameraList* list) {
  std::vector<std::string> names;
  for (int i = 0; i < gp_list_count(list); ++i) {
    const char* name = nullptr;
    if (gp_list_get_name(list, i, &name) >= 0 && name) names.emplace_back(name);
  }
  return names;
}

}  // namespace

struct Session::Handles {
  std::string who;
  Attached where;
  std::string said;  // the library's own words; added to by its callback
  Owned<GPContext> context{gp_context_new()};
  Owned<Camera> camera = made(gp_camera_new);
  bool open = false;
  std::set<std::string> settings_known;  // read at least once

  ~Handles() {
    if (open) gp_camera_exit(camera.get(), context.get());
    camera.reset();
    plugStandardInput();
  }
  auto failed(const std::string& call, int code) {
    std::string what = "camera '" + who + "': " + call + ": " + gp_result_as_string(code) + " (" +
                       std::to_string(code) + ")";
    const std::string words = std::exchange(said, {});
    if (!words.empty()) what += ": " + words;
    if (words.find("Device Busy") != std::string::npos) code = GP_ERROR_CAMERA_BUSY;
    if (words.find("Store Full") != std::string::npos)
      return fail(Errc::kRefused,
                  what + ": its card is full; delete what is not Patina's, or format it");
    return fail(meaningOf(code), what);
  }
};

std::string libraryVersion() {
  const char** lines = gp_library_version(GP_VERSION_SHORT);
  return lines && lines[0] ? lines[0] : "unknown";
}

Attached networkCamera(const std::string& host, int port) {
  const std::string number = std::to_string(port);
  return {"PTP/IP Camera", "ptpip:" + host + ":" + number + ":" + number};
}

std::vector<Attached> attachedOnUsb() {
  const Owned<GPContext> context(gp_context_new());
  const auto ports = portsNow();
  const auto found = made(gp_list_new);
  std::vector<Attached> attached;
  if (gp_abilities_list_detect(models(), ports.get(), found.get(), context.get()) < 0)
    return attached;
  for (int i = 0; i < gp_list_count(found.get()); ++i) {
    const char *model = nullptr, *port = nullptr;
    gp_list_get_name(found.get(), i, &model);
    gp_list_get_value(found.get(), i, &port);
    if (model && port && std::string_view(port).starts_with("usb:") &&
        !std::string_view(port).ends_with(":"))
      attached.push_back({model, port});
  }
  return attached;
}

Session::Session(std::unique_ptr<Handles> handles) : handles_(std::move(handles)) {}
Session::~Session() = default;
const Attached& Session::where() const { return handles_->where; }

Result<std::unique_ptr<Session>> Session::open(const Attached& where, const std::string& who) {
  gp_setting_set(const_cast<char*>("ptp2"), const_cast<char*>("cachetime"), const_cast<char*>("0"));
  auto h = std::make_unique<Handles>();
  h->who = who;
  h->where = where;
  gp_context_set_error_func(h->context.get(), keepErrors, &h->said);

  const int model = gp_abilities_list_lookup_model(models(), where.model.c_str());
  if (model < 0) return h->failed("model '" + where.model + "'", model);
  CameraAbilities abilities;
  gp_abilities_list_get_abilities(models(), model, &abilities);
  gp_camera_set_abilities(h->camera.get(), abilities);

  const auto ports = portsNow();
  const int port = gp_port_info_list_lookup_path(ports.get(), where.port.c_str());
  if (port < 0) return h->failed("port " + where.port, GP_ERROR_IO_USB_FIND);
  GPPortInfo info;
  gp_port_info_list_get_info(ports.get(), port, &info);
  gp_camera_set_port_info(h->camera.get(), info);

  plugStandardInput();
  const SocketCare sockets(where.port);
  if (const int code = gp_camera_init(h->camera.get(), h->context.get()); code < 0) {
    sockets.closeNew();
    return h->failed("open at " + where.port, code == GP_ERROR ? GP_ERROR_IO : code);
  }
  h->open = true;
  return std::unique_ptr<Session>(new Session(std::move(h)));
}

// A setting that cannot be read for any reason, a dead line too, is "bad parameters" to the
// library.
Result<void> Session::fetch(const std::string& setting, const WidgetUse& use) {
  for (int tries = 0;; ++tries) {
    CameraWidget* raw = nullptr;
    const int code = gp_camera_get_single_config(handles_->camera.get(), setting.c_str(), &raw,
                                                 handles_->context.get());
    if (code >= 0) {
      const Owned<CameraWidget> widget(raw);
      handles_->settings_known.insert(setting);
      return use(widget.get());
    }
    if (code != GP_ERROR_BAD_PARAMETERS) return handles_->failed("read " + setting, code);
    if (auto alive = probe(); !alive) return alive;
    if (tries > 0) break;
  }
  if (handles_->settings_known.contains(setting))
    return handles_->failed("read " + setting, GP_ERROR_CAMERA_BUSY);
  return handles_->failed("it has no setting " + setting, GP_ERROR_NOT_SUPPORTED);
}

Result<Setting> Session::read(const std::string& setting) {
  Setting out;
  const auto done = fetch(setting, [&](_CameraWidget* widget) -> Result<void> {
    out = settingOf(widget);
    return {};
  });
  if (!done) return tl::make_unexpected(done.error());
  return out;
}

Result<void> Session::write(const std::string& setting, const std::string& value) {
  return fetch(setting, [&](_CameraWidget* widget) -> Result<void> {
    int code = putValue(widget, value);
    if (code >= 0)
      code = gp_camera_set_single_config(handles_->camera.get(), setting.c_str(), widget,
                                         handles_->context.get());
    if (code < 0) return handles_->failed("set " + setting + " to '" + value + "'", code);
    return {};
  });
}

Result<UtcTime> Session::readClock() {
  auto shown = read("datetime");
  if (!shown) return tl::make_unexpected(shown.error());
  // The library took the camera's digits as local time of this machine: give the digits back.
  const std::time_t taken = std::strtoll(shown->value.c_str(), nullptr, 10);
  std::tm digits{};
  localtime_r(&taken, &digits);
  return UtcTime{std::chrono::seconds(timegm(&digits))};
}

std::vector<std::string> Session::settingNames() {
  std::vector<std::string> names;
  CameraWidget* raw = nullptr;
  if (gp_camera_get_config(handles_->camera.get(), &raw, handles_->context.get()) < 0) return names;
  const Owned<CameraWidget> root(raw);
  collectNames(root.get(), names);
  return names;
}

Result<void> Session::probe() {
  const auto cards = this->cards();
  if (!cards) return tl::make_unexpected(cards.error());
  return {};
}

Result<void> Session::trigger() {
  const int code = gp_camera_trigger_capture(handles_->camera.get(), handles_->context.get());
  if (code < 0) return handles_->failed("trigger", code);
  return {};
}

Result<LibraryEvent> Session::waitForEvent(Nanoseconds most) {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(most).count();
  CameraEventType type = GP_EVENT_UNKNOWN;
  void* raw = nullptr;
  const int code =
      gp_camera_wait_for_event(handles_->camera.get(), static_cast<int>(std::max<long>(ms, 1)),
                               &type, &raw, handles_->context.get());
  const std::unique_ptr<void, MallocFreed> data(raw);  // ours to free, also on an error
  if (code < 0) return handles_->failed("wait for event", code);
  LibraryEvent event;
  switch (type) {
    case GP_EVENT_TIMEOUT:
      break;
    case GP_EVENT_FILE_ADDED: {
      const auto* path = static_cast<const CameraFilePath*>(data.get());
      event.kind = LibraryEvent::kFileAdded;
      event.file = {path->folder, path->name};
      break;
    }
    case GP_EVENT_CAPTURE_COMPLETE:
      event.kind = LibraryEvent::kCaptureComplete;
      break;
    default:
      event.kind = LibraryEvent::kOther;
      if (type == GP_EVENT_UNKNOWN && data) event.text = static_cast<const char*>(data.get());
  }
  return event;
}

std::string CardFile::extension() const {
  const auto dot = name.rfind('.');
  std::string ext = dot == std::string::npos ? "" : lowerCase(name.substr(dot + 1));
  return ext == "jpeg" ? "jpg" : ext;
}

std::string CardFile::stem() const { return name.substr(0, name.rfind('.')); }

void Session::forgetListing() { gp_filesystem_reset(handles_->camera->fs); }

Result<std::vector<CardFile>> Session::list(const std::string& folder) {
  const auto found = made(gp_list_new);
  const int code = gp_camera_folder_list_files(handles_->camera.get(), folder.c_str(), found.get(),
                                               handles_->context.get());
  if (code < 0) return handles_->failed("list " + folder, code);
  std::vector<CardFile> files;
  for (const std::string& name : namesOf(found.get())) files.push_back({folder, name});
  return files;
}

Result<std::vector<std::string>> Session::listFolders(const std::string& folder) {
  const auto found = made(gp_list_new);
  const int code = gp_camera_folder_list_folders(handles_->camera.get(), folder.c_str(),
                                                 found.get(), handles_->context.get());
  if (code < 0) return handles_->failed("list " + folder, code);
  return namesOf(found.get());
}

Result<std::uint64_t> Session::fileBytes(const CardFile& file) {
  CameraFileInfo info{};
  const int code = gp_camera_file_get_info(handles_->camera.get(), file.folder.c_str(),
                                           file.name.c_str(), &info, handles_->context.get());
  if (code < 0) return handles_->failed("size of " + file.path(), code);
  if (!(info.file.fields & GP_FILE_INFO_SIZE))
    return fail(Errc::kCorrupt, "camera '" + handles_->who + "': " + file.path() + " has no size");
  return info.file.size;
}

Result<Bytes> Session::download(const CardFile& file, std::uint64_t bytes_most) {
  const auto size = fileBytes(file);
  if (!size) return tl::make_unexpected(size.error());
  if (*size > bytes_most)
    return fail(Errc::kCorrupt, "camera '" + handles_->who + "': " + file.path() + " would be " +
                                    formatBytes(*size) + ", over the limit of " +
                                    formatBytes(bytes_most));
  const auto content = made(gp_file_new);
  const int code =
      gp_camera_file_get(handles_->camera.get(), file.folder.c_str(), file.name.c_str(),
                         GP_FILE_TYPE_NORMAL, content.get(), handles_->context.get());
  if (code < 0) return handles_->failed("download " + file.path(), code);
  const char* data = nullptr;
  unsigned long length = 0;
  gp_file_get_data_and_size(content.get(), &data, &length);
  const auto* bytes = reinterpret_cast<const std::byte*>(data);
  return Bytes(bytes, bytes + length);
}

Result<void> Session::erase(const CardFile& file) {
  const int code = gp_camera_file_delete(handles_->camera.get(), file.folder.c_str(),
                                         file.name.c_str(), handles_->context.get());
  if (code < 0 && code != GP_ERROR_FILE_NOT_FOUND && code != GP_ERROR_DIRECTORY_NOT_FOUND)
    return handles_->failed("delete " + file.path(), code);
  return {};
}

Result<std::vector<CardSpace>> Session::cards() {
  CameraStorageInformation* raw = nullptr;
  int count = 0;
  const int code =
      gp_camera_get_storageinfo(handles_->camera.get(), &raw, &count, handles_->context.get());
  const std::unique_ptr<CameraStorageInformation, MallocFreed> infos(raw);
  if (code < 0) return handles_->failed("card space", code);
  std::vector<CardSpace> cards;
  for (int i = 0; i < count; ++i)
    cards.push_back({raw[i].label, raw[i].capacitykbytes * 1024, raw[i].freekbytes * 1024,
                     raw[i].access != GP_STORAGEINFO_AC_READWRITE});
  return cards;
}

Result<void> Session::resetPort() {
  if (!handles_->where.port.starts_with("usb:"))
    return fail(Errc::kUnsupported, "camera '" + handles_->who + "': no USB port to reset");
  handles_->open = false;  // nothing more can be said to it
  const int code = gp_port_reset(handles_->camera->port);
  if (code < 0) return handles_->failed("reset " + handles_->where.port, code);
  return {};
}

}  // namespace patina::devices::gphoto2
