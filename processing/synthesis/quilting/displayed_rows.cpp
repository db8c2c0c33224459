// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/displayed_rows.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "processing/image/encoding.h"

namespace patina::quilting {
namespace {

// Channels are counted while compiling where they are few: a texel costs its loads and stores.
template <int channels, class T>
void spreadBy(const float* display, const T* in, std::int64_t count, float* out,
              std::int64_t stride) {
  for (std::int64_t i = 0; i < count; ++i, in += channels)
    for (int c = 0; c < channels; ++c) out[c * stride + i] = display[in[c]];
}
template <class T>
void spreadBy(const float* display, const T* in, std::int64_t count, int channels, float* out,
              std::int64_t stride) {
  if (channels == 3) return spreadBy<3>(display, in, count, out, stride);
  for (int c = 0; c < channels; ++c)
    for (std::int64_t i = 0; i < count; ++i) out[c * stride + i] = display[in[i * channels + c]];
}

// Sixteen texels of three channels at a time.
constexpr int kTexels = 16;
using Codes = std::uint8_t __attribute__((vector_size(kTexels)));

template <int channel, int... texel>
[[gnu::always_inline]] inline void codesOf(const Codes (&in)[3], std::uint8_t* out,
                                           std::integer_sequence<int, texel...>) {
  constexpr auto at = [](int i) { return 3 * i + channel; };  // byte of the three
  const Codes front =
      __builtin_shufflevector(in[0], in[1], (at(texel) < 2 * kTexels ? at(texel) : 0)...);
  const Codes codes = __builtin_shufflevector(
      front, in[2], (at(texel) < 2 * kTexels ? texel : at(texel) - kTexels)...);
  std::memcpy(out, &codes, sizeof codes);
}

void spreadThree(const std::uint8_t* in, std::int64_t count, std::uint8_t* out,
                 std::int64_t stride) {
  constexpr std::make_integer_sequence<int, kTexels> texels;
  std::int64_t i = 0;
  for (; i + kTexels <= count; i += kTexels) {
    Codes codes[3];
    std::memcpy(codes, in + 3 * i, sizeof codes);
    codesOf<0>(codes, out + i, texels);
    codesOf<1>(codes, out + stride + i, texels);
    codesOf<2>(codes, out + 2 * stride + i, texels);
  }
  for (; i < count; ++i)
    for (int c = 0; c < 3; ++c) out[c * stride + i] = in[3 * i + c];
}

}  // namespace

std::vector<float> displayTable(double scale) {
  std::vector<float> table(65536);
  for (int i = 0; i < 65536; ++i)
    table[i] = srgbFromLinear(static_cast<float>(std::min(1.0, i * scale / 65535.0)));
  return table;
}

DisplayedRows::DisplayedRows(double scale, bool coded) {
  if (!coded) {
    display_ = displayTable(scale);
    return;
  }
  for (int code = 0; code < 256; ++code)
    display_.push_back(srgbFromLinear(
        std::min(1.0f, linearFromSrgb(code * kCodeStep) * static_cast<float>(scale))));
}

void DisplayedRows::spread(const std::uint16_t* in, std::int64_t count, int channels, float* out,
                           std::int64_t stride) const {
  spreadBy(display_.data(), in, count, channels, out, stride);
}

void DisplayedRows::spread(const std::uint8_t* in, std::int64_t count, int channels, float* out,
                           std::int64_t stride) const {
  spreadBy(display_.data(), in, count, channels, out, stride);
}

void spreadCodes(const std::uint8_t* in, std::int64_t count, int channels, std::uint8_t* out,
                 std::int64_t stride) {
  if (channels == 3) return spreadThree(in, count, out, stride);
  for (int c = 0; c < channels; ++c)
    for (std::int64_t i = 0; i < count; ++i) out[c * stride + i] = in[i * channels + c];
}

}  // namespace patina::quilting
