// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/memory_tiff.h"

#include <tiffio.h>

#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace patina {

struct MemoryTiff::State {
  std::span<const std::byte> source;
  Bytes written;
  bool writing = false;
  std::uint64_t at = 0;
  std::string error;
  TIFF* tiff = nullptr;

  std::uint64_t size() const { return writing ? written.size() : source.size(); }
  ~State() {
    if (tiff) TIFFClose(tiff);
  }
};

namespace {

template <class State>
tmsize_t readSome(thandle_t handle, void* to, tmsize_t n) {
  auto& s = *static_cast<State*>(handle);
  if (n <= 0 || s.at >= s.size()) return 0;
  const auto count = std::min<std::uint64_t>(static_cast<std::uint64_t>(n), s.size() - s.at);
  const std::byte* from = s.writing ? s.written.data() : s.source.data();
  std::memcpy(to, from + s.at, count);
  s.at += count;
  return static_cast<tmsize_t>(count);
}

template <class State>
tmsize_t writeSome(thandle_t handle, void* from, tmsize_t n) {
  auto& s = *static_cast<State*>(handle);
  if (!s.writing || n < 0) return -1;
  if (s.at + n > s.written.size()) s.written.resize(s.at + n);
  std::memcpy(s.written.data() + s.at, from, static_cast<std::size_t>(n));
  s.at += static_cast<std::uint64_t>(n);
  return n;
}

template <class State>
toff_t seekTo(thandle_t handle, toff_t offset, int whence) {
  auto& s = *static_cast<State*>(handle);
  s.at = whence == SEEK_SET ? offset : whence == SEEK_CUR ? s.at + offset : s.size() + offset;
  return s.at;
}

int closeNothing(thandle_t) { return 0; }

template <class State>
toff_t sizeOf(thandle_t handle) {
  return static_cast<State*>(handle)->size();
}

// The bytes are in memory already: libtiff may read them in place.
template <class State>
int mapAll(thandle_t handle, void** base, toff_t* size) {
  auto& s = *static_cast<State*>(handle);
  if (s.writing) return 0;
  *base = const_cast<std::byte*>(s.source.data());
  *size = s.source.size();
  return 1;
}
void unmapNothing(thandle_t, void*, toff_t) {}

template <class State>
int keepError(TIFF*, void* user, const char*, const char* format, va_list arguments) {
  char text[200];
  std::vsnprintf(text, sizeof text, format, arguments);
  static_cast<State*>(user)->error = text;
  return 1;
}
int ignoreWarning(TIFF*, void*, const char*, const char*, va_list) { return 1; }

template <class State>
void open(State& s, const char* mode) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  TIFFOpenOptionsSetErrorHandlerExtR(options, keepError<State>, &s);
  TIFFOpenOptionsSetWarningHandlerExtR(options, ignoreWarning, nullptr);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, tmsize_t{1} << 31);
  s.tiff = TIFFClientOpenExt("memory", mode, &s, readSome<State>, writeSome<State>, seekTo<State>,
                             closeNothing, sizeOf<State>, mapAll<State>, unmapNothing, options);
  TIFFOpenOptionsFree(options);
}

}  // namespace

MemoryTiff::MemoryTiff(std::unique_ptr<State> state) : state_(std::move(state)) {}
MemoryTiff::~MemoryTiff() = default;
MemoryTiff::MemoryTiff(MemoryTiff&&) noexcept = default;

MemoryTiff MemoryTiff::reading(std::span<const std::byte> file) {
  auto state = std::make_unique<State>();
  state->source = file;
  open(*state, "r");
  if (!state->tiff)
    throw ProcessingError(Exit::kBadData, "the TIFF cannot be read (" + state->error +
                                              "): it is damaged or truncated; copy it again");
  return MemoryTiff(std::move(state));
}

MemoryTiff MemoryTiff::writing() {
  auto state = std::make_unique<State>();
  state->writing = true;
  open(*state, "wl");
  PATINA_CHECK(state->tiff != nullptr);
  return MemoryTiff(std::move(state));
}

TIFF* MemoryTiff::handle() const { return state_->tiff; }
const std::string& MemoryTiff::lastError() const { return state_->error; }

std::uint16_t MemoryTiff::shortTag(std::uint32_t tag, std::uint16_t fallback) const {
  std::uint16_t value = 0;
  return TIFFGetFieldDefaulted(handle(), tag, &value) ? value : fallback;
}
std::uint32_t MemoryTiff::longTag(std::uint32_t tag, std::uint32_t fallback) const {
  std::uint32_t value = 0;
  return TIFFGetFieldDefaulted(handle(), tag, &value) ? value : fallback;
}

Bytes MemoryTiff::finish() {
  TIFFClose(state_->tiff);
  state_->tiff = nullptr;
  return std::move(state_->written);
}

}  // namespace patina
