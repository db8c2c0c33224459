// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/pixel_format.h"

#include <linux/videodev2.h>

#include <algorithm>

namespace patina::devices::v4l2 {
namespace {

using enum PixelLayout;
using enum PixelFormat::Kind;

constexpr std::array<std::uint8_t, 4> kBggr{2, 1, 1, 0}, kGbrg{1, 2, 0, 1}, kGrbg{1, 0, 2, 1},
    kRggb{0, 1, 1, 2}, kNone{};

constexpr PixelFormat kFormats[] = {
    {"yuyv", V4L2_PIX_FMT_YUYV, kColour, kYuyv, 8, kNone},
    {"mjpeg", V4L2_PIX_FMT_MJPEG, kJpeg, kByte, 8, kNone},
    {"jpeg", V4L2_PIX_FMT_JPEG, kJpeg, kByte, 8, kNone},
    {"yvyu", V4L2_PIX_FMT_YVYU, kColour, kYvyu, 8, kNone},
    {"uyvy", V4L2_PIX_FMT_UYVY, kColour, kUyvy, 8, kNone},
    {"vyuy", V4L2_PIX_FMT_VYUY, kColour, kVyuy, 8, kNone},
    {"nv12", V4L2_PIX_FMT_NV12, kColour, kNv12, 8, kNone},
    {"rgb24", V4L2_PIX_FMT_RGB24, kColour, kRgb24, 8, kNone},
    {"bgr24", V4L2_PIX_FMT_BGR24, kColour, kBgr24, 8, kNone},
    {"grey", V4L2_PIX_FMT_GREY, kGrey, kByte, 8, kNone},
    {"y10", V4L2_PIX_FMT_Y10, kGrey, kLittle16, 10, kNone},
    {"y10b", V4L2_PIX_FMT_Y10BPACK, kGrey, kBitStream, 10, kNone},
    {"y10p", V4L2_PIX_FMT_Y10P, kGrey, kMipi, 10, kNone},
    {"y12", V4L2_PIX_FMT_Y12, kGrey, kLittle16, 12, kNone},
    {"y14", V4L2_PIX_FMT_Y14, kGrey, kLittle16, 14, kNone},
    {"y16", V4L2_PIX_FMT_Y16, kGrey, kLittle16, 16, kNone},
    {"y16be", V4L2_PIX_FMT_Y16_BE, kGrey, kBig16, 16, kNone},
    {"bggr8", V4L2_PIX_FMT_SBGGR8, kMosaic, kByte, 8, kBggr},
    {"gbrg8", V4L2_PIX_FMT_SGBRG8, kMosaic, kByte, 8, kGbrg},
    {"grbg8", V4L2_PIX_FMT_SGRBG8, kMosaic, kByte, 8, kGrbg},
    {"rggb8", V4L2_PIX_FMT_SRGGB8, kMosaic, kByte, 8, kRggb},
    {"bggr10", V4L2_PIX_FMT_SBGGR10, kMosaic, kLittle16, 10, kBggr},
    {"gbrg10", V4L2_PIX_FMT_SGBRG10, kMosaic, kLittle16, 10, kGbrg},
    {"grbg10", V4L2_PIX_FMT_SGRBG10, kMosaic, kLittle16, 10, kGrbg},
    {"rggb10", V4L2_PIX_FMT_SRGGB10, kMosaic, kLittle16, 10, kRggb},
    {"bggr10p", V4L2_PIX_FMT_SBGGR10P, kMosaic, kMipi, 10, kBggr},
    {"gbrg10p", V4L2_PIX_FMT_SGBRG10P, kMosaic, kMipi, 10, kGbrg},
    {"grbg10p", V4L2_PIX_FMT_SGRBG10P, kMosaic, kMipi, 10, kGrbg},
    {"rggb10p", V4L2_PIX_FMT_SRGGB10P, kMosaic, kMipi, 10, kRggb},
    {"bggr12", V4L2_PIX_FMT_SBGGR12, kMosaic, kLittle16, 12, kBggr},
    {"gbrg12", V4L2_PIX_FMT_SGBRG12, kMosaic, kLittle16, 12, kGbrg},
    {"grbg12", V4L2_PIX_FMT_SGRBG12, kMosaic, kLittle16, 12, kGrbg},
    {"rggb12", V4L2_PIX_FMT_SRGGB12, kMosaic, kLittle16, 12, kRggb},
    {"bggr12p", V4L2_PIX_FMT_SBGGR12P, kMosaic, kMipi, 12, kBggr},
    {"gbrg12p", V4L2_PIX_FMT_SGBRG12P, kMosaic, kMipi, 12, kGbrg},
    {"grbg12p", V4L2_PIX_FMT_SGRBG12P, kMosaic, kMipi, 12, kGrbg},
    {"rggb12p", V4L2_PIX_FMT_SRGGB12P, kMosaic, kMipi, 12, kRggb},
    {"bggr14", V4L2_PIX_FMT_SBGGR14, kMosaic, kLittle16, 14, kBggr},
    {"gbrg14", V4L2_PIX_FMT_SGBRG14, kMosaic, kLittle16, 14, kGbrg},
    {"grbg14", V4L2_PIX_FMT_SGRBG14, kMosaic, kLittle16, 14, kGrbg},
    {"rggb14", V4L2_PIX_FMT_SRGGB14, kMosaic, kLittle16, 14, kRggb},
    {"bggr14p", V4L2_PIX_FMT_SBGGR14P, kMosaic, kMipi, 14, kBggr},
    {"gbrg14p", V4L2_PIX_FMT_SGBRG14P, kMosaic, kMipi, 14, kGbrg},
    {"grbg14p", V4L2_PIX_FMT_SGRBG14P, kMosaic, kMipi, 14, kGrbg},
    {"rggb14p", V4L2_PIX_FMT_SRGGB14P, kMosaic, kMipi, 14, kRggb},
    {"bggr16", V4L2_PIX_FMT_SBGGR16, kMosaic, kLittle16, 16, kBggr},
    {"gbrg16", V4L2_PIX_FMT_SGBRG16, kMosaic, kLittle16, 16, kGbrg},
    {"grbg16", V4L2_PIX_FMT_SGRBG16, kMosaic, kLittle16, 16, kGrbg},
    {"rggb16", V4L2_PIX_FMT_SRGGB16, kMosaic, kLittle16, 16, kRggb},
};

}  // namespace

std::span<const PixelFormat> pixelFormats() { return kFormats; }

const PixelFormat* formatNamed(const std::string& name) {
  const auto* found =
      std::ranges::find_if(kFormats, [&](const PixelFormat& f) { return f.name == name; });
  return found == std::end(kFormats) ? nullptr : found;
}

const PixelFormat* formatOf(std::uint32_t fourcc) {
  const auto* found =
      std::ranges::find_if(kFormats, [&](const PixelFormat& f) { return f.fourcc == fourcc; });
  return found == std::end(kFormats) ? nullptr : found;
}

std::vector<std::string> formatNames() {
  std::vector<std::string> names;
  for (const PixelFormat& format : kFormats) names.emplace_back(format.name);
  return names;
}

std::string fourccText(std::uint32_t fourcc) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const auto c = static_cast<char>(fourcc >> (8 * i) & 0x7F);
    text += c < ' ' ? '?' : c;
  }
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return (fourcc & (1u << 31)) != 0 ? text + "-BE" : text;
}

}  // namespace patina::devices::v4l2
