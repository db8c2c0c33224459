// SPDX-License-Identifier: GPL-3.0-or-later
// All of libcamera is here: its API changes with every release.
#include <libcamera/libcamera.h>
#include <libcamera/version.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>

#include "devices/libcamera/found_camera.h"
#include "devices/libcamera/inbox.h"
#include "devices/libcamera/libcamera_devices.h"
#include "devices/libcamera/mapped_plane.h"
#include "devices/libcamera/pipeline_camera.h"

#if LIBCAMERA_VERSION_MAJOR != 0 || LIBCAMERA_VERSION_MINOR != 0 || LIBCAMERA_VERSION_PATCH != 3
#error \
    "this file is written for libcamera 0.0.3 of Debian 12; port it, the rest of the folder stays"
#endif

namespace patina::devices::libcamera {
namespace {

namespace lc = ::libcamera;

// The library allows one manager a process and aborts at the second.
std::shared_ptr<lc::CameraManager> sharedManager(int* error) {
  static std::mutex mutex;
  static std::weak_ptr<lc::CameraManager> shared;
  const std::lock_guard lock(mutex);
  if (auto manager = shared.lock()) return manager;
  setenv("LIBCAMERA_LOG_LEVELS", "*:WARN", 0);  // it greets on stderr; a user's own wish stands
  auto manager = std::make_shared<lc::CameraManager>();
  if ((*error = manager->start()) < 0) return nullptr;
  shared = manager;
  return manager;
}

std::string reason(int error) { return std::strerror(std::abs(error)); }

std::string listed(lc::CameraManager& manager) {
  std::string all;
  for (const auto& camera : manager.cameras())
    all += (all.empty() ? "'" : ", '") + camera->id() + "'";
  return all.empty() ? "none" : all;
}

lc::StreamRole roleFor(Wish wish) {
  return wish == Wish::kDng || wish == Wish::kGrey ? lc::StreamRole::Raw
                                                   : lc::StreamRole::StillCapture;
}

SizePx sizeOf(const lc::Size& size) {
  return {static_cast<int>(size.width), static_cast<int>(size.height)};
}

std::vector<OfferedFormat> offersOf(const lc::StreamFormats& formats) {
  std::vector<OfferedFormat> offers;
  for (const lc::PixelFormat& pixel : formats.pixelformats()) {
    OfferedFormat offer{pixel.toString(), {}, {}, {}};
    for (const lc::Size& size : formats.sizes(pixel)) offer.sizes.push_back(sizeOf(size));
    const lc::SizeRange range = formats.range(pixel);
    if (range.max != range.min) {
      offer.least = sizeOf(range.min);
      offer.most = sizeOf(range.max);
    }
    offers.push_back(std::move(offer));
  }
  return offers;
}

YuvCoding codingOf(const std::optional<lc::ColorSpace>& space) {
  YuvCoding coding = kBt601;
  if (!space) return coding;
  if (space->ycbcrEncoding == lc::ColorSpace::YcbcrEncoding::Rec709) coding = kBt709;
  coding.full_range = space->range == lc::ColorSpace::Range::Full;
  return coding;
}

std::string modelOf(const lc::Camera& camera) {
  return camera.properties().get(lc::properties::Model).value_or(camera.id());
}

class LibcameraPipeline final : public Pipeline {
 public:
  explicit LibcameraPipeline(Clock& clock) : clock_(clock) {}
  ~LibcameraPipeline() override { close(); }

  Result<OpenCamera> open(const CameraSettings& settings) override;
  void close() override;
  void forget() override {
    close();
    manager_.reset();
  }
  Result<void> attached() const override {
    if (camera_ && !completed_->lost()) return {};
    return fail(Errc::kLost, who_ + ": was unplugged");
  }
  Result<void> start(const Controls& controls) override;
  void stop() override;
  Result<std::optional<Frame>> next(MonoTime deadline) override;
  Result<Bytes> pixels() override;

 private:
  auto no(Errc code, const std::string& what) const { return fail(code, who_ + ": " + what); }
  bool has(const lc::ControlId& control) const { return camera_->controls().count(&control) > 0; }
  Result<void> setStream(const CameraSettings& settings);
  Result<void> shareBuffers();
  Result<void> queue(lc::Request* request);
  void fill(lc::ControlList& list) const;
  Metadata metadataOf(lc::Request& request) const;

  Clock& clock_;
  std::string who_;
  std::shared_ptr<lc::CameraManager> manager_;
  std::shared_ptr<lc::Camera> camera_;
  std::unique_ptr<lc::CameraConfiguration> config_;
  std::unique_ptr<lc::FrameBufferAllocator> allocator_;
  std::vector<std::unique_ptr<lc::Request>> requests_;
  std::map<const lc::FrameBuffer*, std::vector<MappedPlane>> mappings_;
  std::shared_ptr<Inbox> completed_;  // the library's slots hold it too
  StreamFormat format_;
  Controls controls_;
  lc::Request* last_ = nullptr;
  bool streaming_ = false;
};

Result<OpenCamera> LibcameraPipeline::open(const CameraSettings& settings) {
  close();
  who_ = settings.who;
  int error = 0;
  if (!manager_ && !(manager_ = sharedManager(&error)))
    return no(Errc::kLost, "libcamera does not start: " + reason(error));
  camera_ = manager_->get(settings.camera_id);
  if (!camera_)
    return no(Errc::kLost, "no camera '" + settings.camera_id +
                               "' is attached; there are: " + listed(*manager_));
  if ((error = camera_->acquire()) < 0) {
    camera_.reset();
    if (error == -EBUSY)
      return no(Errc::kBusy, "another program has the camera: end it (fuser -v /dev/media*)");
    return no(Errc::kLost, "cannot be acquired: " + reason(error));
  }
  completed_ = std::make_shared<Inbox>();
  camera_->requestCompleted.connect(camera_.get(), [box = completed_](lc::Request* done) {
    if (done->status() != lc::Request::RequestCancelled) box->add(done->cookie());
  });
  camera_->disconnected.connect(camera_.get(), [box = completed_] { box->lose(); });
  Result<void> ready = setStream(settings);
  if (ready) ready = shareBuffers();
  if (!ready) {
    close();
    return tl::make_unexpected(ready.error());
  }
  OpenCamera open{modelOf(*camera_), format_};
  open.has_exposure = has(lc::controls::ExposureTime);
  open.has_gain = has(lc::controls::AnalogueGain);
  open.has_colour_gains = has(lc::controls::ColourGains);
  open.has_focus = has(lc::controls::LensPosition);
  return open;
}

Result<void> LibcameraPipeline::setStream(const CameraSettings& settings) {
  config_ = camera_->generateConfiguration({roleFor(settings.wish)});
  if (!config_ || config_->empty())
    return no(Errc::kRefused, "has no such stream; choose another format in its settings");
  lc::StreamConfiguration& stream = config_->at(0);
  const auto choice = chooseStream(offersOf(stream.formats()), settings);
  if (!choice) return tl::make_unexpected(choice.error());
  for (const lc::PixelFormat& pixel : stream.formats().pixelformats())
    if (pixel.toString() == choice->format->name) stream.pixelFormat = pixel;
  stream.size = {static_cast<unsigned>(choice->size.width),
                 static_cast<unsigned>(choice->size.height)};
  const std::string asked = stream.toString();
  const lc::PixelFormat pixel = stream.pixelFormat;
  const bool any_size = settings.size.width == 0;  // the largest that is offered may not be one
  if (config_->validate() == lc::CameraConfiguration::Invalid || stream.pixelFormat != pixel ||
      (!any_size && stream.toString() != asked))
    return no(Errc::kRefused, "asked for " + asked + ", offered " + stream.toString());
  if (const int error = camera_->configure(config_.get()); error < 0)
    return no(error == -ENODEV ? Errc::kLost : Errc::kRefused,
              "does not take " + asked + ": " + reason(error));
  format_ = {choice->format, sizeOf(stream.size), stream.stride, codingOf(stream.colorSpace)};
  return {};
}

Result<void> LibcameraPipeline::shareBuffers() {
  lc::Stream* stream = config_->at(0).stream();
  allocator_ = std::make_unique<lc::FrameBufferAllocator>(camera_);
  if (const int error = allocator_->allocate(stream); error < 0)
    return no(Errc::kLost, "gives no buffers: " + reason(error));
  for (const auto& buffer : allocator_->buffers(stream)) {
    auto request = camera_->createRequest(requests_.size());
    if (!request || request->addBuffer(stream, buffer.get()) < 0)
      return no(Errc::kLost, "takes no request");
    auto& planes = mappings_[buffer.get()];
    for (const auto& plane : buffer->planes()) {
      planes.emplace_back(plane.fd.get(), plane.offset, plane.length);
      if (!planes.back().good()) return no(Errc::kLost, "its buffers cannot be mapped");
    }
    requests_.push_back(std::move(request));
  }
  return {};
}

void LibcameraPipeline::close() {
  stop();
  requests_.clear();
  mappings_.clear();
  allocator_.reset();
  config_.reset();
  if (!camera_) return;
  camera_->requestCompleted.disconnect(camera_.get());
  camera_->disconnected.disconnect(camera_.get());
  camera_->release();
  camera_.reset();
}

void LibcameraPipeline::fill(lc::ControlList& list) const {
  if (has(lc::controls::AeEnable)) list.set(lc::controls::AeEnable, false);
  if (has(lc::controls::AwbEnable)) list.set(lc::controls::AwbEnable, false);
  if (controls_.exposure) {
    const std::int64_t us =
        std::chrono::round<std::chrono::microseconds>(*controls_.exposure).count();
    list.set(lc::controls::ExposureTime, static_cast<std::int32_t>(us));
    // Else the frame rate that a pipeline prefers cuts long exposures short.
    if (has(lc::controls::FrameDurationLimits))
      list.set(lc::controls::FrameDurationLimits,
               lc::Span<const std::int64_t, 2>({us + us / 20 + 2000, us + us / 20 + 2000}));
  }
  if (controls_.analogue_gain)
    list.set(lc::controls::AnalogueGain, static_cast<float>(*controls_.analogue_gain));
  if (controls_.colour_gains)
    list.set(lc::controls::ColourGains,
             lc::Span<const float, 2>({static_cast<float>((*controls_.colour_gains)[0]),
                                       static_cast<float>((*controls_.colour_gains)[1])}));
  if (has(lc::controls::AfMode)) list.set(lc::controls::AfMode, lc::controls::AfModeManual);
  if (controls_.focus_dioptres)
    list.set(lc::controls::LensPosition, static_cast<float>(*controls_.focus_dioptres));
}

Result<void> LibcameraPipeline::queue(lc::Request* request) {
  fill(request->controls());
  const int error = camera_->queueRequest(request);
  if (error == 0) return {};
  if (error == -ENODEV || completed_->lost()) return no(Errc::kLost, "was unplugged");
  return no(Errc::kTimeout, "takes no request: " + reason(error));
}

Result<void> LibcameraPipeline::start(const Controls& controls) {
  stop();
  if (auto there = attached(); !there) return there;
  controls_ = controls;
  completed_->clear();
  lc::ControlList first(camera_->controls());
  fill(first);
  if (const int error = camera_->start(&first); error < 0)
    return no(error == -ENODEV ? Errc::kLost : Errc::kTimeout, "does not start: " + reason(error));
  streaming_ = true;
  for (const auto& request : requests_) {
    request->reuse(lc::Request::ReuseBuffers);
    if (auto queued = queue(request.get()); !queued) {
      stop();
      return queued;
    }
  }
  return {};
}

void LibcameraPipeline::stop() {
  last_ = nullptr;
  if (!streaming_) return;
  streaming_ = false;
  camera_->stop();  // of a lost camera it does nothing
}

Result<std::optional<Frame>> LibcameraPipeline::next(MonoTime deadline) {
  if (lc::Request* done = std::exchange(last_, nullptr)) {
    done->reuse(lc::Request::ReuseBuffers);
    if (auto queued = queue(done); !queued) return tl::make_unexpected(queued.error());
  }
  const auto number = completed_->next(clock_, deadline);
  if (!number) {
    if (auto there = attached(); !there) return tl::make_unexpected(there.error());
    return std::optional<Frame>();
  }
  last_ = requests_.at(*number).get();
  Frame frame;
  for (const auto& [stream, buffer] : last_->buffers())
    frame.damaged = frame.damaged || buffer->metadata().status != lc::FrameMetadata::FrameSuccess;
  frame.metadata = metadataOf(*last_);
  return frame;
}

Metadata LibcameraPipeline::metadataOf(lc::Request& request) const {
  const lc::ControlList& said = request.metadata();
  Metadata metadata;
  metadata.sequence = request.sequence();
  if (const auto us = said.get(lc::controls::ExposureTime))
    metadata.applied.exposure = std::chrono::microseconds(*us);
  if (const auto gain = said.get(lc::controls::AnalogueGain))
    metadata.applied.analogue_gain = *gain;
  if (const auto gain = said.get(lc::controls::DigitalGain)) metadata.digital_gain = *gain;
  if (const auto gains = said.get(lc::controls::ColourGains))
    metadata.applied.colour_gains = {{(*gains)[0], (*gains)[1]}};
  if (const auto lens = said.get(lc::controls::LensPosition))
    metadata.applied.focus_dioptres = *lens;
  if (const auto stamp = said.get(lc::controls::SensorTimestamp); stamp && *stamp > 0)
    metadata.stamp = Nanoseconds(*stamp);
  return metadata;
}

Result<Bytes> LibcameraPipeline::pixels() {
  if (!last_) return no(Errc::kTimeout, "there is no frame");
  const lc::FrameBuffer* buffer = last_->buffers().begin()->second;
  const auto& planes = mappings_.at(buffer);
  Bytes all;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    std::size_t bytes = buffer->metadata().planes()[i].bytesused;
    // Rows below the picture, where a plane has some, would shift the next one.
    if (i == 0 && planes.size() > 1)
      bytes = std::min(bytes, format_.row_bytes * static_cast<std::size_t>(format_.size.height));
    planes[i].appendTo(all, bytes);
  }
  return all;
}

AttachedCamera attachedCamera(lc::Camera& camera) {
  AttachedCamera told{camera.id(), modelOf(camera), lc::CameraManager::version(), "ready"};
  const int error = camera.acquire();
  if (error < 0) told.state = error == -EBUSY ? "busy" : reason(error);
  constexpr std::pair<lc::StreamRole, const char*> kRoles[] = {
      {lc::StreamRole::StillCapture, "processed"}, {lc::StreamRole::Raw, "raw"}};
  for (const auto& [role, name] : kRoles) {
    const auto config = camera.generateConfiguration({role});
    if (config && !config->empty())
      told.streams.emplace_back(name, offersOf(config->at(0).formats()));
  }
  if (error == 0) camera.release();
  const std::pair<const lc::ControlId*, const char*> kControls[] = {
      {&lc::controls::ExposureTime, "exposure, us"},
      {&lc::controls::AnalogueGain, "analogue gain"},
      {&lc::controls::ColourGains, "colour gains"},
      {&lc::controls::LensPosition, "focus, dioptres"},
      {&lc::controls::FrameDurationLimits, "frame duration, us"}};
  for (const auto& [id, name] : kControls)
    if (const auto it = camera.controls().find(id->id()); it != camera.controls().end())
      told.controls.emplace_back(
          name, it->second.min().toString() + " to " + it->second.max().toString());
  told.has_exposure = camera.controls().count(&lc::controls::ExposureTime) > 0;
  return told;
}

}  // namespace

std::unique_ptr<Pipeline> makePipeline(Clock& clock) {
  return std::make_unique<LibcameraPipeline>(clock);
}

std::unique_ptr<Camera> makeCamera(const CameraSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock) {
  return std::make_unique<PipelineCamera>(spec, readCameraSettings(spec, rig_file),
                                          makePipeline(clock), clock);
}

std::vector<FoundDevice> find() {
  int error = 0;
  const auto manager = sharedManager(&error);
  if (!manager) return {libraryThatDoesNotStart(reason(error))};
  std::vector<FoundDevice> all;
  for (const auto& camera : manager->cameras()) all.push_back(describe(attachedCamera(*camera)));
  return all;
}

}  // namespace patina::devices::libcamera
