// SPDX-License-Identifier: GPL-3.0-or-later
// The one bridge to cv::Mat, without a copy either way. Only .cpp files include this.
// OpenCV's own threads stay off: forEachRow and callers run on the one pool (oneTBB), and Debian's
// OpenCV sits on the same library.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "processing/image/image.h"

namespace patina {

template <class T>
constexpr int cvDepth() {
  using Value = std::remove_const_t<T>;
  if constexpr (std::is_same_v<Value, std::uint8_t>) return CV_8U;
  if constexpr (std::is_same_v<Value, std::uint16_t>) return CV_16U;
  if constexpr (std::is_same_v<Value, std::int32_t>) return CV_32S;
  if constexpr (std::is_same_v<Value, float>) return CV_32F;
  if constexpr (std::is_same_v<Value, double>) return CV_64F;
}

// Borrows the texels: the view's owner must outlive the Mat, and a view of const texels must not
// be written through it. At most CV_CN_MAX (512) channels.
template <class T>
cv::Mat asMat(ImageView<T> view) {
  using Value = std::remove_const_t<T>;
  PATINA_CHECK(view.channels >= 1 && view.channels <= CV_CN_MAX);
  return cv::Mat(view.height, view.width, CV_MAKETYPE(cvDepth<T>(), view.channels),
                 const_cast<Value*>(view.data),
                 static_cast<std::size_t>(view.row_stride) * sizeof(Value));
}

// Borrows the Mat's texels, which must be of type T.
template <class T>
ImageView<T> viewOf(cv::Mat& mat) {
  PATINA_CHECK(mat.depth() == cvDepth<T>() && mat.dims == 2 && mat.step[0] % sizeof(T) == 0);
  return {mat.ptr<T>(), mat.cols, mat.rows, mat.channels(),
          static_cast<std::ptrdiff_t>(mat.step[0] / sizeof(T))};
}

}  // namespace patina
