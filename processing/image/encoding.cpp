// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/encoding.h"

#include <array>
#include <cmath>
#include <memory>

#include "processing/image/parallel_rows.h"

namespace patina {
namespace {

double srgbOf(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}
double linearOf(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

float clamped(float v) { return v >= 0 ? std::min(v, 1.0f) : 0.0f; }  // NaN becomes 0

// round(255 srgb(x)) exactly: the cell of x names the lower code, one comparison with the
// threshold above it the final one. The steepest slope, 12.92 * 255 / 4096 = 0.8 codes a cell,
// keeps at most one threshold inside a cell.
struct FloatToCode {
  static constexpr int kCells = 4096;
  std::array<std::uint8_t, kCells + 1> code_below;
  std::array<float, 256> threshold;  // from this value on, code + 1

  FloatToCode() {
    for (int code = 0; code < 256; ++code)
      threshold[code] = code < 255 ? static_cast<float>(linearOf((code + 0.5) / 255.0)) : 2.0f;
    int code = 0;
    for (int cell = 0; cell <= kCells; ++cell) {
      while (threshold[code] <= static_cast<float>(cell) / kCells) ++code;
      code_below[cell] = static_cast<std::uint8_t>(code);
    }
  }
  std::uint8_t operator()(float linear) const {
    const float v = clamped(linear);
    const std::uint8_t code = code_below[static_cast<int>(v * kCells)];
    return static_cast<std::uint8_t>(code + (v >= threshold[code] ? 1 : 0));
  }
};

const FloatToCode& floatToCode() {
  static const FloatToCode table;
  return table;
}

const std::vector<std::uint8_t>& codesOf16() {
  static const std::vector<std::uint8_t> table = [] {
    std::vector<std::uint8_t> t(65536);
    for (int i = 0; i < 65536; ++i) t[i] = floatToCode()(static_cast<float>(i) / 65535.0f);
    return t;
  }();
  return table;
}

template <int kCodes>
const std::vector<float>& linearOfCodes() {
  static const std::vector<float> table = [] {
    std::vector<float> t(kCodes);
    for (int i = 0; i < kCodes; ++i)
      t[i] = static_cast<float>(linearOf(i / static_cast<double>(kCodes - 1)));
    return t;
  }();
  return table;
}

template <class Out, class In, class Convert>
Image<Out> mapSamples(ImageView<const In> in, const Convert& convert) {
  Image<Out> out(in.width, in.height, in.channels);
  const std::int64_t samples = static_cast<std::int64_t>(in.width) * in.channels;
  const ImageView<Out> to = out.view();
  forEachRow(in.height, samples, [&](int y) {
    const In* from = in.row(y);
    Out* row = to.row(y);
    for (std::int64_t i = 0; i < samples; ++i) row[i] = convert(from[i]);
  });
  return out;
}

}  // namespace

float srgbFromLinear(float linear) { return static_cast<float>(srgbOf(clamped(linear))); }
float linearFromSrgb(float encoded) { return static_cast<float>(linearOf(clamped(encoded))); }

std::uint8_t encodeSrgb8(float linear) { return floatToCode()(linear); }

Image<std::uint8_t> encodeSrgb8(ImageView<const float> linear) {
  const FloatToCode& table = floatToCode();
  return mapSamples<std::uint8_t>(linear, [&](float v) { return table(v); });
}

Image<std::uint8_t> encodeSrgb8(ImageView<const std::uint16_t> linear) {
  const std::uint8_t* table = codesOf16().data();
  return mapSamples<std::uint8_t>(linear, [=](std::uint16_t v) { return table[v]; });
}

Image<float> decodeSrgb(ImageView<const std::uint8_t> encoded) {
  const float* table = linearOfCodes<256>().data();
  return mapSamples<float>(encoded, [=](std::uint8_t v) { return table[v]; });
}

Image<float> decodeSrgb(ImageView<const std::uint16_t> encoded) {
  const float* table = linearOfCodes<65536>().data();
  return mapSamples<float>(encoded, [=](std::uint16_t v) { return table[v]; });
}

Image<std::uint16_t> quantize16(ImageView<const float> linear) {
  return mapSamples<std::uint16_t>(linear, [](float v) {
    const float shifted = clamped(v) * 65535.0f + 0.5f;  // never negative: cutting rounds
    return static_cast<std::uint16_t>(shifted);
  });
}

}  // namespace patina
