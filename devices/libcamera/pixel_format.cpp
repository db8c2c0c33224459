// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/pixel_format.h"

#include <algorithm>
#include <cstdint>

namespace patina::devices::libcamera {
namespace {

using Kind = PixelFormat::Kind;

std::vector<PixelFormat> mosaics() {
  struct Order {
    const char* name;
    std::array<std::uint8_t, 4> cfa;
  };
  constexpr Order kOrders[] = {{"SRGGB", {0, 1, 1, 2}},
                               {"SGRBG", {1, 0, 2, 1}},
                               {"SGBRG", {1, 2, 0, 1}},
                               {"SBGGR", {2, 1, 1, 0}}};
  std::vector<PixelFormat> all;
  for (const Order& order : kOrders) {
    const std::string name = order.name;
    all.push_back({name + "16", Kind::kMosaic, PixelLayout::kLittle16, 16, order.cfa});
    for (const int bits : {12, 10}) {
      const std::string full = name + std::to_string(bits);
      all.push_back({full, Kind::kMosaic, PixelLayout::kLittle16, bits, order.cfa});
      all.push_back({full + "_CSI2P", Kind::kMosaic, PixelLayout::kMipi, bits, order.cfa});
    }
    all.push_back({name + "8", Kind::kMosaic, PixelLayout::kByte, 8, order.cfa});
  }
  return all;
}

// Best first within a kind. libcamera names bytes from the top of a word, as DRM does: its BGR888
// is R, G, B in memory.
const std::vector<PixelFormat>& formats() {
  static const std::vector<PixelFormat> kFormats = [] {
    std::vector<PixelFormat> all{{"BGR888", Kind::kColour, PixelLayout::kRgb24},
                                 {"RGB888", Kind::kColour, PixelLayout::kBgr24},
                                 {"YUYV", Kind::kColour, PixelLayout::kYuyv},
                                 {"YVYU", Kind::kColour, PixelLayout::kYvyu},
                                 {"UYVY", Kind::kColour, PixelLayout::kUyvy},
                                 {"VYUY", Kind::kColour, PixelLayout::kVyuy},
                                 {"NV12", Kind::kColour, PixelLayout::kNv12},
                                 {"MJPEG", Kind::kJpeg},
                                 {"R12", Kind::kGrey, PixelLayout::kLittle16, 12},
                                 {"R10", Kind::kGrey, PixelLayout::kLittle16, 10},
                                 {"R10_CSI2P", Kind::kGrey, PixelLayout::kMipi, 10},
                                 {"R8", Kind::kGrey, PixelLayout::kByte, 8}};
    const std::vector<PixelFormat> raw = mosaics();
    all.insert(all.end(), raw.begin(), raw.end());
    return all;
  }();
  return kFormats;
}

// Lower is better; a mosaic's order of colours is the sensor's and no matter of taste.
std::size_t rank(const PixelFormat& format, Wish wish) {
  if (wish == Wish::kJpeg && format.kind == Kind::kJpeg) return 0;
  if (format.kind == Kind::kMosaic)
    return 2 * static_cast<std::size_t>(16 - format.bits) + (format.layout == PixelLayout::kMipi);
  return 1 + static_cast<std::size_t>(&format - formats().data());
}

bool serves(const PixelFormat& format, Wish wish) {
  switch (wish) {
    case Wish::kPng:
      return format.kind == Kind::kColour;
    case Wish::kJpeg:
      return format.kind == Kind::kColour || format.kind == Kind::kJpeg;
    case Wish::kDng:
      return format.kind == Kind::kMosaic;
    case Wish::kGrey:
      break;
  }
  return format.kind == Kind::kGrey;
}

std::string text(SizePx size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

bool isLarger(SizePx a, SizePx b) {
  return std::int64_t{a.width} * a.height > std::int64_t{b.width} * b.height;
}

SizePx sizeOf(const OfferedFormat& format, SizePx wanted) {
  if (wanted.width == 0) {
    SizePx largest = format.most;
    for (const SizePx& size : format.sizes)
      if (isLarger(size, largest)) largest = size;
    return largest;
  }
  const bool listed_one =
      std::find(format.sizes.begin(), format.sizes.end(), wanted) != format.sizes.end();
  const bool within = wanted.width >= format.least.width && wanted.width <= format.most.width &&
                      wanted.height >= format.least.height && wanted.height <= format.most.height;
  return listed_one || within ? wanted : SizePx{};
}

}  // namespace

std::string text(const std::vector<OfferedFormat>& offered) {
  constexpr std::size_t kListed = 6;
  std::string all;
  for (const OfferedFormat& format : offered) {
    all += (all.empty() ? "" : "; ") + format.name;
    if (format.sizes.size() > kListed) {
      all += " in " + std::to_string(format.sizes.size()) + " sizes up to " +
             text(sizeOf(format, SizePx{}));
    } else {
      for (const SizePx& size : format.sizes) all += " " + text(size);
    }
    if (format.most.width > 0) all += " " + text(format.least) + " to " + text(format.most);
  }
  return all.empty() ? "nothing" : all;
}

const PixelFormat* formatNamed(const std::string& name) {
  for (const PixelFormat& format : formats())
    if (format.name == name) return &format;
  return nullptr;
}

Result<StreamChoice> chooseStream(const std::vector<OfferedFormat>& offered,
                                  const CameraSettings& settings) {
  StreamChoice best;
  for (const OfferedFormat& offer : offered) {
    const PixelFormat* format = formatNamed(offer.name);
    if (!format || !serves(*format, settings.wish)) continue;
    const SizePx size = sizeOf(offer, settings.size);
    if (size.width == 0) continue;
    if (!best.format || rank(*format, settings.wish) < rank(*best.format, settings.wish))
      best = {format, size};
  }
  if (best.format) return best;
  return fail(Errc::kRefused, settings.who +
                                  ": no stream of the format and size that the rig file asks for; "
                                  "the camera offers: " +
                                  text(offered));
}

std::vector<std::string> wishesServed(const std::vector<OfferedFormat>& offered) {
  constexpr std::pair<Wish, const char*> kWishes[] = {
      {Wish::kPng, "png"}, {Wish::kJpeg, "jpg"}, {Wish::kDng, "dng"}, {Wish::kGrey, "grey"}};
  std::vector<std::string> served;
  for (const auto& [wish, name] : kWishes) {
    const bool any = std::any_of(offered.begin(), offered.end(), [wish = wish](const auto& offer) {
      const PixelFormat* format = formatNamed(offer.name);
      return format && serves(*format, wish);
    });
    if (any) served.emplace_back(name);
  }
  return served;
}

}  // namespace patina::devices::libcamera
