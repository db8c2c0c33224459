// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room only: owners of libav objects and their errors. Only .cpp files include this.
#pragma once

#include <memory>
#include <string>

struct AVCodecContext;
struct AVFormatContext;
struct AVFrame;
struct AVPacket;
struct SwsContext;

namespace patina {

struct FreeLibav {
  void operator()(AVCodecContext* c) const;
  void operator()(AVFrame* f) const;
  void operator()(AVPacket* p) const;
  void operator()(SwsContext* s) const;
};
template <class T>
using LibavPtr = std::unique_ptr<T, FreeLibav>;

std::string libavText(int error);
void silenceLibav();  // it logs on stderr by default; its errors reach the caller by value

}  // namespace patina
