// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/body.h"

#include <algorithm>
#include <utility>

#include "devices/twin/twin_devices.h"
#include "processing/image/exif_block.h"
#include "processing/image/failure.h"
#include "processing/image/random.h"

namespace patina::devices::twin::dslr {
namespace {

constexpr Nanoseconds kSubSecond = std::chrono::milliseconds(10);  // what the EXIF time resolves
constexpr int kJpegQuality = 95;
constexpr const char* kMake = "Patina";

const CameraSpec& cameraOf(const World& world, const std::string& id) {
  const auto& cameras = world.spec().cameras;
  const auto found = id.empty() ? cameras.begin() : std::ranges::find(cameras, id, &CameraSpec::id);
  if (found == cameras.end())
    throw Failure(Exit::kConfig, "the rig has no camera" + (id.empty() ? "" : " '" + id + "'") +
                                     " whose eyes a virtual DSLR could have");
  return *found;
}

ExifFacts exifOf(const RawMosaic& raw) {
  return {raw.exposure, raw.iso, raw.f_number, raw.taken_utc, raw.make, raw.model, raw.serial};
}

// 2024-05-01T12:00:00.320Z as 20240501T120000.3
std::string ptpTime(UtcTime t) {
  std::string text = formatUtc(t).substr(0, 21);
  std::erase_if(text, [](char c) { return c == '-' || c == ':'; });
  return text;
}

std::optional<UtcTime> parsePtpTime(const std::string& text) {
  if (text.size() < 15 || text[8] != 'T') return std::nullopt;
  std::string form = text.substr(0, 4) + "-" + text.substr(4, 2) + "-" + text.substr(6, 5) + ":" +
                     text.substr(11, 2) + ":" + text.substr(13);
  if (!form.ends_with('Z')) form += 'Z';
  try {
    return parseUtc(form);
  } catch (const ProcessingError&) {
    return std::nullopt;
  }
}

}  // namespace

Body::Body(std::shared_ptr<World> world, DslrOptions options)
    : settings(pictureLayout(world->spec(), cameraOf(*world, options.camera)).size),
      card(options.card_bytes, options.memory_bytes,
           static_cast<std::uint32_t>(options.shutter_count) + 1),
      world_(std::move(world)),
      options_(std::move(options)),
      seed_(deviceSeed(*world_, cameraOf(*world_, options_.camera).id + options_.serial)),
      maker_(*world_, cameraOf(*world_, options_.camera), CameraPose{}, seed_),
      developer_(world_->profile().sensor.black_level, world_->profile().sensor.whiteLevel()),
      bytes_a_picture_(std::int64_t{pictureSize().width} * pictureSize().height * 4 + 8192) {
  truth.shutter_count = options_.shutter_count;
  settings.set(Property::kShutterCount, static_cast<std::int64_t>(truth.shutter_count));
}

UtcTime Body::cameraTime() const { return clock().utc() + options_.clock_off; }

void Body::refreshTime() { settings.setText(Property::kDateTime, ptpTime(cameraTime())); }

bool Body::setTime(const std::string& text) {
  const auto time = parsePtpTime(text);
  if (!time) return false;
  options_.clock_off = *time - clock().utc();
  return true;
}

void Body::chooseExposure() {
  const std::uint64_t own = hashSeed(seed_, truth.shutter_count, 0xae);
  const auto program = settings.value(Property::kExposureProgram);
  if ((program == kProgram || program == kAperture) && uniform(own) < 0.5) settings.turnTheDial();
}

Answer Body::capture(std::uint32_t transaction, const CaptureTrouble& trouble) {
  if (shot_) return Answer::kDeviceBusy;
  OpenShot shot;
  shot.store = settings.value(Property::kSaveTo) == kToMemory ? kMemoryStore : kCardStore;
  if (trouble.full || card.free(shot.store) < bytes_a_picture_) return Answer::kStoreFull;
  shot.transaction = transaction;
  shot.trouble = trouble;
  chooseExposure();
  const Exposure exposure = settings.exposure();
  const Nanoseconds begin = world_->runTime();
  shot.picture.begin_utc = clock().utc();
  shot.picture.begin_mono = clock().mono();
  shot.picture.camera_time = std::chrono::floor<std::chrono::milliseconds>(cameraTime());
  shot.picture.camera_time -= shot.picture.camera_time.time_since_epoch() % kSubSecond;
  shot.picture.exposure = exposure;
  shot.picture.levels = world_->levelsOver(begin, exposure.time);
  shot.picture.stale = trouble.stale && !previous_.empty();
  if (!shot.picture.stale) ++truth.shutter_count;
  settings.set(Property::kShutterCount, static_cast<std::int64_t>(truth.shutter_count));
  shot.picture.count = truth.shutter_count;
  shot.light = {begin, exposure, shot.picture.levels, world_->temperatureAt(begin),
                hashSeed(seed_, truth.shutter_count)};
  shot.compression = settings.value(Property::kCompression);
  shot.done = shot.picture.begin_mono + exposure.time + options_.save;
  shot_ = std::move(shot);
  return Answer::kOk;
}

std::vector<CardObject> Body::develop(const OpenShot& shot) {
  RawMosaic raw = maker_.expose(shot.light);
  raw.taken_utc = shot.picture.camera_time;
  raw.make = kMake;
  raw.model = options_.model;
  raw.serial = options_.serial;
  std::vector<CardObject> files;
  const auto add = [&](ObjectFormat format, Bytes bytes) {
    CardObject file;
    file.format = format;
    file.taken = shot.picture.camera_time;
    file.size = pictureSize();
    file.bytes = std::make_shared<const Bytes>(std::move(bytes));
    files.push_back(std::move(file));
  };
  if (shot.compression != kJpegOnly) add(ObjectFormat::kDng, encodeDng(raw));
  if (shot.compression != kRawOnly)
    add(ObjectFormat::kJpeg,
        jpegWithExif(encodeJpeg(developer_(raw).view(), kJpegQuality), exifOf(raw)));
  return files;
}

void Body::store(OpenShot& shot, std::vector<CardObject> files) {
  const auto handles = card.add(shot.store, std::move(files));
  for (const std::uint32_t handle : handles) {
    const CardObject& file = *card.find(handle);
    TrueFile entry;
    entry.handle = handle;
    entry.store = shot.store;
    entry.name = file.name;
    entry.raw = file.format == ObjectFormat::kDng;
    entry.bytes = file.length();
    entry.hash = sha256(*file.bytes);
    shot.picture.files.push_back(entry);
  }
  for (int time = 0; time < shot.trouble.times; ++time)
    for (const std::uint32_t handle : handles)
      say({EventCode::kObjectAdded, shot.transaction, {handle}}, shot.trouble.late);
  for (int time = 0; time < shot.trouble.times; ++time)
    say({EventCode::kCaptureComplete, shot.transaction, {shot.transaction}}, shot.trouble.late);
  truth.pictures.push_back(std::move(shot.picture));
}

void Body::finishDue() {
  if (!shot_ || shot_->done > clock().mono()) return;
  OpenShot shot = std::move(*std::exchange(shot_, std::nullopt));
  if (!shot.picture.stale) previous_ = develop(shot);
  store(shot, previous_);
}

void Body::remove(std::uint32_t handle) {
  PATINA_CHECK(card.remove(handle));
  for (TruePicture& picture : truth.pictures)
    for (TrueFile& file : picture.files)
      if (file.handle == handle) file.deleted_utc = clock().utc();
}

void Body::say(const PtpEvent& event, Nanoseconds late) {
  events_.push_back({event, clock().mono() + late});
}

std::vector<PtpEvent> Body::takeEvents() {
  std::vector<PtpEvent> due;
  const MonoTime now = clock().mono();
  std::erase_if(events_, [&](const PlannedEvent& planned) {
    if (planned.due > now) return false;
    if (session_open) due.push_back(planned.event);
    return true;
  });
  return due;
}

std::optional<MonoTime> Body::nextDue() const {
  std::optional<MonoTime> next;
  if (shot_) next = shot_->done;
  for (const PlannedEvent& planned : events_)
    if (!next || planned.due < *next) next = planned.due;
  return next;
}

void Body::losePower() {
  shot_.reset();
  events_.clear();
  session_open = false;
  ++truth.power_losses;
  card.removeAll(kMemoryStore);
  for (TruePicture& picture : truth.pictures)
    for (TrueFile& file : picture.files)
      if (file.store == kMemoryStore && !file.deleted_utc) file.lost = true;
}

}  // namespace patina::devices::twin::dslr
