// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/frame_format.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

namespace patina::devices::v4l2 {
namespace {

constexpr std::uint32_t kFormatsMost = 200, kSizesMost = 200;
constexpr double kRateNearEnough = 0.01;

std::string text(SizePx s) { return std::to_string(s.width) + "x" + std::to_string(s.height); }

SizePx sizeOf(std::uint32_t width, std::uint32_t height) {
  return {static_cast<int>(width), static_cast<int>(height)};
}

void addSizes(const Node& node, OfferedFormat& format) {
  v4l2_frmsizeenum size{};
  size.pixel_format = format.fourcc;
  for (; size.index < kSizesMost && node.ask(VIDIOC_ENUM_FRAMESIZES, &size) == 0; ++size.index) {
    if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      format.sizes.push_back(sizeOf(size.discrete.width, size.discrete.height));
      continue;
    }
    format.any_between = true;
    format.sizes = {sizeOf(size.stepwise.min_width, size.stepwise.min_height),
                    sizeOf(size.stepwise.max_width, size.stepwise.max_height)};
    return;
  }
  std::sort(format.sizes.begin(), format.sizes.end(), [](SizePx a, SizePx b) {
    return std::int64_t{a.width} * a.height < std::int64_t{b.width} * b.height;
  });
}

YuvCoding codingOf(const v4l2_pix_format& pix) {
  const auto space = static_cast<v4l2_colorspace>(pix.colorspace);
  std::uint32_t encoding = pix.ycbcr_enc;
  if (encoding == V4L2_YCBCR_ENC_DEFAULT) encoding = V4L2_MAP_YCBCR_ENC_DEFAULT(space);
  std::uint32_t range = pix.quantization;
  if (range == V4L2_QUANTIZATION_DEFAULT)
    range = V4L2_MAP_QUANTIZATION_DEFAULT(false, space, encoding);
  const bool bt709 = encoding == V4L2_YCBCR_ENC_709 || encoding == V4L2_YCBCR_ENC_XV709;
  YuvCoding coding = bt709 ? kBt709 : kBt601;
  coding.full_range = range == V4L2_QUANTIZATION_FULL_RANGE;
  return coding;
}

bool isLinear(const v4l2_pix_format& pix, Transfer transfer) {
  if (transfer != Transfer::kDriver) return transfer == Transfer::kLinear;
  const auto space = static_cast<v4l2_colorspace>(pix.colorspace);
  std::uint32_t function = pix.xfer_func;
  if (function == V4L2_XFER_FUNC_DEFAULT) function = V4L2_MAP_XFER_FUNC_DEFAULT(space);
  return function == V4L2_XFER_FUNC_NONE;
}

Result<SizePx> chosenSize(const Node& node, const CameraSettings& settings) {
  const std::vector<OfferedFormat> offered = offeredFormats(node);
  const auto found = std::find_if(offered.begin(), offered.end(), [&](const OfferedFormat& f) {
    return f.fourcc == settings.format->fourcc;
  });
  if (found == offered.end()) {
    std::string names;
    for (const OfferedFormat& f : offered) {
      const PixelFormat* known = formatOf(f.fourcc);
      if (known) names += (names.empty() ? "" : ", ") + std::string(known->name);
    }
    return fail(Errc::kRefused, node.who() + ": the camera has no format '" +
                                    settings.format->name + "'; settings.format can be " +
                                    (names.empty() ? "none that is known" : names));
  }
  if (settings.size.width == 0) {
    if (found->sizes.empty())
      return fail(Errc::kRefused, node.who() + ": the driver lists no sizes: say settings.size");
    return found->sizes.back();
  }
  const auto& sizes = found->sizes;
  if (sizes.empty() || found->any_between ||
      std::find(sizes.begin(), sizes.end(), settings.size) != sizes.end())
    return settings.size;
  std::string choices;
  for (const SizePx size : sizes) choices += (choices.empty() ? "" : ", ") + text(size);
  return fail(Errc::kRefused, node.who() + ": the camera has no size " + text(settings.size) +
                                  " in '" + settings.format->name + "'; there are " + choices);
}

// From frame to frame, as read back.
Result<Nanoseconds> setRate(const Node& node, double frames_per_second) {
  v4l2_streamparm parm{};
  parm.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  const auto stated = fromSeconds(frames_per_second > 0 ? 1 / frames_per_second : 0);
  if (node.ask(VIDIOC_G_PARM, &parm) != 0) {
    if (frames_per_second > 0) return stated;
    return fail(Errc::kRefused,
                node.who() +
                    ": the driver does not say its frame rate: say "
                    "settings.frames_per_second, or no frame can be told from an older one");
  }
  if (frames_per_second > 0) {
    parm.parm.capture.timeperframe = {
        1000, static_cast<std::uint32_t>(std::lround(1000 * frames_per_second))};
    if (auto done = node.call(VIDIOC_S_PARM, &parm, "set the frame rate"); !done)
      return tl::make_unexpected(done.error());
  }
  const v4l2_fract& time = parm.parm.capture.timeperframe;
  if (time.numerator == 0 || time.denominator == 0) {
    if (frames_per_second > 0) return stated;
    return fail(Errc::kRefused, node.who() +
                                    ": the driver does not say its frame rate: say "
                                    "settings.frames_per_second");
  }
  const double got = static_cast<double>(time.denominator) / time.numerator;
  if (frames_per_second > 0 &&
      std::abs(got - frames_per_second) > kRateNearEnough * frames_per_second)
    return fail(Errc::kRefused, node.who() + ": asked for " + std::to_string(frames_per_second) +
                                    " frames per second, the camera says " + std::to_string(got));
  return fromSeconds(1 / got);
}

}  // namespace

std::vector<OfferedFormat> offeredFormats(const Node& node) {
  std::vector<OfferedFormat> offered;
  v4l2_fmtdesc format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; format.index < kFormatsMost && node.ask(VIDIOC_ENUM_FMT, &format) == 0; ++format.index) {
    OfferedFormat one;
    one.fourcc = format.pixelformat;
    one.description = reinterpret_cast<const char*>(format.description);
    addSizes(node, one);
    offered.push_back(std::move(one));
  }
  return offered;
}

Result<FrameFormat> setFrameFormat(const Node& node, const CameraSettings& settings) {
  const auto size = chosenSize(node, settings);
  if (!size) return tl::make_unexpected(size.error());
  v4l2_format format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  v4l2_pix_format& pix = format.fmt.pix;
  pix.width = static_cast<std::uint32_t>(size->width);
  pix.height = static_cast<std::uint32_t>(size->height);
  pix.pixelformat = settings.format->fourcc;
  pix.field = V4L2_FIELD_NONE;
  if (auto done = node.call(VIDIOC_S_FMT, &format, "set the format"); !done)
    return tl::make_unexpected(done.error());
  if (pix.pixelformat != settings.format->fourcc || !(sizeOf(pix.width, pix.height) == *size))
    return fail(Errc::kRefused, node.who() + ": asked for " + text(*size) + " " +
                                    fourccText(settings.format->fourcc) + ", the camera set " +
                                    text(sizeOf(pix.width, pix.height)) + " " +
                                    fourccText(pix.pixelformat));
  if (pix.field != V4L2_FIELD_NONE && pix.field != V4L2_FIELD_ANY)
    return fail(Errc::kUnsupported, node.who() + ": the camera sends half pictures (interlaced)");
  const auto interval = setRate(node, settings.frames_per_second);
  if (!interval) return tl::make_unexpected(interval.error());
  FrameFormat agreed;
  agreed.pixel = settings.format;
  agreed.size = *size;
  agreed.row_bytes = pix.bytesperline;
  agreed.image_bytes = pix.sizeimage;
  agreed.coding = codingOf(pix);
  agreed.linear = isLinear(pix, settings.transfer);
  agreed.interval = *interval;
  return agreed;
}

}  // namespace patina::devices::v4l2
