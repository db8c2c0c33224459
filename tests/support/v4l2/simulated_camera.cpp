// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/v4l2/simulated_camera.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "processing/image/picture_file.h"
#include "processing/image/random.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kPage = 4096;
constexpr std::uint32_t kBuffersMost = 8;

template <std::size_t N>
void put(__u8 (&to)[N], const std::string& text) {
  std::strncpy(reinterpret_cast<char*>(to), text.c_str(), N - 1);
}

// Noise that no two frames share; a JPEG where the format is one.
std::vector<std::byte> noise(const SimulatedFrame& frame, std::size_t bytes) {
  if (frame.fourcc == V4L2_PIX_FMT_MJPEG) {
    Image<std::uint8_t> grey(frame.size.width, frame.size.height, 1);
    for (std::size_t i = 0; i < grey.texels().size(); ++i)
      grey.texels()[i] = static_cast<std::uint8_t>(uniformBelow(hashSeed(frame.sequence, i), 200));
    return encodeJpeg(std::as_const(grey).view());
  }
  std::vector<std::byte> all(bytes);
  for (std::size_t i = 0; i < bytes; ++i)
    all[i] = static_cast<std::byte>(uniformBelow(hashSeed(frame.sequence, i), 200));
  return all;
}

}  // namespace

SimulatedCamera::SimulatedCamera(devices::Clock& clock)
    : formats{{V4L2_PIX_FMT_YUYV, {{64, 48}, {32, 24}}, 16},
              {V4L2_PIX_FMT_MJPEG, {{64, 48}, {32, 24}}, 16}},
      colorspace(V4L2_COLORSPACE_SRGB),
      stamp_flags(V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE),
      device_caps(V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING | V4L2_CAP_EXT_PIX_FORMAT),
      interval(10ms),
      clock_(clock) {}

void SimulatedCamera::plugIn() {
  attached_ = true;
  streaming_ = false;
  buffers_ = 0;
  controls.toDefaults();
}

int SimulatedCamera::call(unsigned long request, void* argument) {
  const std::lock_guard lock(mutex_);
  if (!attached_) return ENODEV;
  if (const auto failing = fails.find(request); failing != fails.end()) return failing->second;
  return answer(request, argument);
}

int SimulatedCamera::answer(unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCAP:
      return describe(*static_cast<v4l2_capability*>(argument));
    case VIDIOC_ENUM_FMT:
      return listFormat(*static_cast<v4l2_fmtdesc*>(argument));
    case VIDIOC_ENUM_FRAMESIZES:
      return listSize(*static_cast<v4l2_frmsizeenum*>(argument));
    case VIDIOC_S_FMT:
      return setFormat(*static_cast<v4l2_format*>(argument), true);
    case VIDIOC_TRY_FMT:
      return setFormat(*static_cast<v4l2_format*>(argument), false);
    case VIDIOC_G_PARM:
      return rate(*static_cast<v4l2_streamparm*>(argument), false);
    case VIDIOC_S_PARM:
      return rate(*static_cast<v4l2_streamparm*>(argument), true);
    case VIDIOC_QUERYCTRL:
      return controls.query(*static_cast<v4l2_queryctrl*>(argument));
    case VIDIOC_QUERYMENU:
      return controls.queryMenu(*static_cast<v4l2_querymenu*>(argument));
    case VIDIOC_G_CTRL:
      return controls.get(*static_cast<v4l2_control*>(argument));
    case VIDIOC_S_CTRL:
      return controls.set(*static_cast<v4l2_control*>(argument));
    case VIDIOC_REQBUFS:
      return askBuffers(*static_cast<v4l2_requestbuffers*>(argument));
    case VIDIOC_QUERYBUF:
      return queryBuffer(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_QBUF:
      return queue(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_DQBUF:
      return dequeue(*static_cast<v4l2_buffer*>(argument));
    case VIDIOC_STREAMON:
      return switchStream(true);
    case VIDIOC_STREAMOFF:
      return switchStream(false);
    default:
      return ENOTTY;
  }
}

int SimulatedCamera::describe(v4l2_capability& caps) const {
  caps = {};
  put(caps.driver, "simulated");
  put(caps.card, model);
  put(caps.bus_info, "usb-simulated");
  caps.device_caps = device_caps;
  caps.capabilities = device_caps | V4L2_CAP_DEVICE_CAPS;
  return 0;
}

int SimulatedCamera::listFormat(v4l2_fmtdesc& format) const {
  if (format.type != V4L2_BUF_TYPE_VIDEO_CAPTURE || format.index >= formats.size()) return EINVAL;
  format.pixelformat = formats[format.index].fourcc;
  put(format.description, "simulated");
  return 0;
}

int SimulatedCamera::listSize(v4l2_frmsizeenum& size) const {
  const auto found = std::find_if(formats.begin(), formats.end(), [&](const SimulatedFormat& f) {
    return f.fourcc == size.pixel_format;
  });
  if (found == formats.end() || size.index >= found->sizes.size()) return EINVAL;
  size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
  size.discrete.width = static_cast<std::uint32_t>(found->sizes[size.index].width);
  size.discrete.height = static_cast<std::uint32_t>(found->sizes[size.index].height);
  return 0;
}

// As drivers do: what is not there becomes what is.
int SimulatedCamera::setFormat(v4l2_format& format, bool keep) {
  if (format.type != V4L2_BUF_TYPE_VIDEO_CAPTURE) return EINVAL;
  if (keep && buffers_ > 0) return EBUSY;
  v4l2_pix_format& pix = format.fmt.pix;
  const auto has = [&](const SimulatedFormat& f) { return f.fourcc == pix.pixelformat; };
  auto found = std::find_if(formats.begin(), formats.end(), has);
  if (found == formats.end()) found = formats.begin();
  const SizePx asked{static_cast<int>(pix.width), static_cast<int>(pix.height)};
  const bool offered =
      std::find(found->sizes.begin(), found->sizes.end(), asked) != found->sizes.end();
  const SizePx size = offered ? asked : found->sizes.front();
  pix = {};
  pix.pixelformat = found->fourcc;
  pix.width = static_cast<std::uint32_t>(size.width);
  pix.height = static_cast<std::uint32_t>(size.height);
  pix.field = V4L2_FIELD_NONE;
  pix.bytesperline =
      pix.pixelformat == V4L2_PIX_FMT_MJPEG ? 0 : (pix.width * found->bits_a_pixel + 7) / 8;
  pix.sizeimage = pix.bytesperline > 0 ? pix.bytesperline * pix.height : pix.width * pix.height * 3;
  pix.colorspace = colorspace;
  pix.ycbcr_enc = ycbcr_enc;
  pix.quantization = quantization;
  pix.xfer_func = xfer_func;
  if (keep) format_ = pix;
  return 0;
}

int SimulatedCamera::rate(v4l2_streamparm& parm, bool set) {
  if (!tells_rate) return ENOTTY;
  v4l2_fract& time = parm.parm.capture.timeperframe;
  if (set && time.denominator > 0)
    interval = Nanoseconds{1'000'000'000ll * time.numerator / time.denominator};
  parm.parm.capture = {};
  parm.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
  time = {static_cast<std::uint32_t>(interval.count() / 1000), 1'000'000};
  return 0;
}

std::size_t SimulatedCamera::slotBytes() const {
  return (format_.sizeimage + kPage - 1) / kPage * kPage;
}

int SimulatedCamera::askBuffers(v4l2_requestbuffers& request) {
  if (request.memory != V4L2_MEMORY_MMAP) return EINVAL;
  if (request.count > 0 && buffers_ > 0) return EBUSY;
  request.count = std::min(request.count, kBuffersMost);
  buffers_ = request.count;
  queued_.clear();
  done_.clear();
  if (buffers_ > 0 && ftruncate(file_, static_cast<off_t>(buffers_ * slotBytes())) != 0)
    return ENOMEM;
  return 0;
}

int SimulatedCamera::queryBuffer(v4l2_buffer& buffer) const {
  if (buffer.index >= buffers_) return EINVAL;
  buffer.m.offset = static_cast<std::uint32_t>(buffer.index * slotBytes());
  buffer.length = format_.sizeimage;
  buffer.flags = 0;
  return 0;
}

int SimulatedCamera::queue(v4l2_buffer& buffer) {
  if (buffer.index >= buffers_) return EINVAL;
  expose();  // what ended before found no buffer
  queued_.push_back(buffer.index);
  return 0;
}

int SimulatedCamera::switchStream(bool on) {
  if (on && buffers_ == 0) return EINVAL;
  streaming_ = on;
  next_end_ = clock_.mono() + interval;
  next_sequence_ = 0;
  done_.clear();
  if (!on) queued_.clear();
  return 0;
}

void SimulatedCamera::expose() {
  if (!streaming_ || silent) return;
  const std::int32_t units = controls.value(V4L2_CID_EXPOSURE_ABSOLUTE, 100);
  const Nanoseconds exposure = units * 100us;
  // A sensor cannot send faster than it gathers light.
  const Nanoseconds step = std::max(interval, exposure);
  const Nanoseconds held = pipeline_frames * step;
  for (; next_end_ + held <= clock_.mono(); next_end_ += step, ++next_sequence_) {
    if (queued_.empty() || lost.contains(next_sequence_)) continue;
    SimulatedFrame frame;
    frame.fourcc = format_.pixelformat;
    frame.sequence = next_sequence_;
    frame.size = {static_cast<int>(format_.width), static_cast<int>(format_.height)};
    frame.row_bytes = format_.bytesperline;
    frame.began = next_end_ - interval - exposure;
    frame.arrived = next_end_ + held;
    frame.exposure_units = units;
    done_.push_back({queued_.front(), frame});
    queued_.pop_front();
  }
}

int SimulatedCamera::dequeue(v4l2_buffer& buffer) {
  expose();
  if (done_.empty()) return EAGAIN;
  const Done done = done_.front();
  done_.pop_front();
  const std::vector<std::byte> bytes =
      paint ? paint(done.frame) : noise(done.frame, format_.sizeimage);
  const auto offset = static_cast<off_t>(done.index * slotBytes());
  if (pwrite(file_, bytes.data(), bytes.size(), offset) != static_cast<ssize_t>(bytes.size()))
    return EIO;
  const bool start = (stamp_flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  // Of the start: when the first row arrives, as uvcvideo has it.
  const std::int64_t stamp_ns = toNs(start ? done.frame.arrived - interval : done.frame.arrived);
  buffer.index = done.index;
  buffer.sequence = done.frame.sequence;
  buffer.bytesused = static_cast<std::uint32_t>(bytes.size());
  buffer.length = format_.sizeimage;
  buffer.m.offset = static_cast<std::uint32_t>(offset);
  buffer.flags = V4L2_BUF_FLAG_DONE | V4L2_BUF_FLAG_MAPPED | stamp_flags;
  buffer.field = V4L2_FIELD_NONE;
  buffer.timestamp.tv_sec = stamp_ns / 1'000'000'000;
  buffer.timestamp.tv_usec = stamp_ns % 1'000'000'000 / 1000;
  if (spoil) spoil(buffer);
  ++handed_over_;
  if (after_frame) after_frame();
  return 0;
}

}  // namespace patina::testing
