// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/displayed_rows.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "processing/image/encoding.h"

namespace patina::quilting {
namespace {

constexpr float kCodeStep = 1 / 255.0f;

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
using Codes4 = std::uint8_t __attribute__((vector_size(4)));
using Values4 = float __attribute__((vector_size(16)));

template <int channel, int... texel>
[[gnu::always_inline]] inline Codes codesOf(const Codes (&in)[3],
                                            std::integer_sequence<int, texel...>) {
  constexpr auto at = [](int i) { return 3 * i + channel; };  // byte of the three
  const Codes front =
      __builtin_shufflevector(in[0], in[1], (at(texel) < 2 * kTexels ? at(texel) : 0)...);
  return __builtin_shufflevector(front, in[2],
                                 (at(texel) < 2 * kTexels ? texel : at(texel) - kTexels)...);
}

template <int channel>
[[gnu::always_inline]] inline void spreadCodesOf(const Codes (&in)[3], float* out) {
  const Codes codes = codesOf<channel>(in, std::make_integer_sequence<int, kTexels>{});
  for (int i = 0; i < kTexels; i += 4) {
    Codes4 four;
    std::memcpy(&four, reinterpret_cast<const std::uint8_t*>(&codes) + i, sizeof four);
    const Values4 values = __builtin_convertvector(four, Values4) * kCodeStep;
    std::memcpy(out + i, &values, sizeof values);
  }
}

[[gnu::always_inline]] inline void spreadCodes(const std::uint8_t* in, std::int64_t count,
                                               float* out, std::int64_t stride) {
  std::int64_t i = 0;
  for (; i + kTexels <= count; i += kTexels) {
    Codes codes[3];
    std::memcpy(codes, in + 3 * i, sizeof codes);
    spreadCodesOf<0>(codes, out + i);
    spreadCodesOf<1>(codes, out + stride + i);
    spreadCodesOf<2>(codes, out + 2 * stride + i);
  }
  for (; i < count; ++i)
    for (int c = 0; c < 3; ++c) out[c * stride + i] = in[3 * i + c] * kCodeStep;
}

[[gnu::target("avx2")]] void spreadCodesAvx2(const std::uint8_t* in, std::int64_t count, float* out,
                                             std::int64_t stride) {
  spreadCodes(in, count, out, stride);
}
void spreadCodesPlain(const std::uint8_t* in, std::int64_t count, float* out, std::int64_t stride) {
  spreadCodes(in, count, out, stride);
}
const auto spreadThreeCodes = __builtin_cpu_supports("avx2") ? spreadCodesAvx2 : spreadCodesPlain;

}  // namespace

std::vector<float> displayTable(double scale) {
  std::vector<float> table(65536);
  for (int i = 0; i < 65536; ++i)
    table[i] = srgbFromLinear(static_cast<float>(std::min(1.0, i * scale / 65535.0)));
  return table;
}

DisplayedRows::DisplayedRows(double scale, bool coded) : coded_as_displayed_(coded && scale == 1) {
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
  if (coded_as_displayed_ && channels == 3)
    spreadThreeCodes(in, count, out, stride);
  else
    spreadBy(display_.data(), in, count, channels, out, stride);
}

}  // namespace patina::quilting
