// SPDX-License-Identifier: GPL-3.0-or-later
// Image<T> owns texels, ImageView<T> borrows them. Layout [y][x][channel], channels interleaved.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "processing/image/failure.h"
#include "processing/image/units.h"

namespace patina {

// What a texel's number means. Linear light unless tagged otherwise.
enum class Encoding { kLinear, kSrgb };

// Borrowed, copyable, never null when non-empty. `row_stride` counts elements, not bytes.
template <class T>
struct ImageView {
  T* data = nullptr;
  int width = 0, height = 0, channels = 1;
  std::ptrdiff_t row_stride = 0;

  bool empty() const { return width == 0 || height == 0; }
  SizePx size() const { return {width, height}; }
  T* row(int y) const { return data + y * row_stride; }
  std::span<T> texel(int x, int y) const {
    return {row(y) + static_cast<std::ptrdiff_t>(x) * channels, static_cast<std::size_t>(channels)};
  }
  T& at(int x, int y, int c = 0) const {
    return row(y)[static_cast<std::ptrdiff_t>(x) * channels + c];
  }
  ImageView crop(RectPx r) const {
    PATINA_CHECK(r.x >= 0 && r.y >= 0 && r.width >= 0 && r.height >= 0 && r.x + r.width <= width &&
                 r.y + r.height <= height);
    return {row(r.y) + static_cast<std::ptrdiff_t>(r.x) * channels, r.width, r.height, channels,
            row_stride};
  }
  operator ImageView<const T>() const requires(!std::is_const_v<T>) {
    return {data, width, height, channels, row_stride};
  }
};

template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, int channels, T fill = T{})
      : width_(width),
        height_(height),
        channels_(channels),
        texels_(static_cast<std::size_t>(width) * height * channels, fill) {}

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  SizePx size() const { return {width_, height_}; }
  bool empty() const { return texels_.empty(); }
  std::vector<T>& texels() { return texels_; }
  const std::vector<T>& texels() const { return texels_; }

  ImageView<T> view() { return {texels_.data(), width_, height_, channels_, stride()}; }
  ImageView<const T> view() const { return {texels_.data(), width_, height_, channels_, stride()}; }
  T& at(int x, int y, int c = 0) { return view().at(x, y, c); }
  const T& at(int x, int y, int c = 0) const { return view().at(x, y, c); }

 private:
  std::ptrdiff_t stride() const { return static_cast<std::ptrdiff_t>(width_) * channels_; }
  int width_ = 0, height_ = 0, channels_ = 1;
  std::vector<T> texels_;
};

template <class T>
Image<T> copyOf(ImageView<const T> v) {
  Image<T> out(v.width, v.height, v.channels);
  for (int y = 0; y < v.height; ++y)
    std::copy_n(v.row(y), static_cast<std::size_t>(v.width) * v.channels, out.view().row(y));
  return out;
}

}  // namespace patina
