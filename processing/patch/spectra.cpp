// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/spectra.h"

#include <fftw3.h>

#include <cstring>
#include <mutex>

#include "processing/image/failure.h"

namespace patina::patch {
namespace {

// FFTW's planner keeps tables of its own without a lock.
std::mutex& plannerMutex() {
  static std::mutex shared;
  return shared;
}

// The least length from `n` on that has no prime factor above 7.
int quickLength(int n) {
  for (;; ++n) {
    int rest = n;
    for (int prime : {2, 3, 5, 7})
      while (rest % prime == 0) rest /= prime;
    if (rest == 1) return n;
  }
}

template <class T>
struct Release {
  void operator()(T* p) const { fftwf_free(p); }
};
template <class T>
using Buffer = std::unique_ptr<T[], Release<T>>;
Buffer<float> realBuffer(std::size_t n) { return Buffer<float>(fftwf_alloc_real(n)); }
Buffer<fftwf_complex> complexBuffer(std::size_t n) {
  return Buffer<fftwf_complex>(fftwf_alloc_complex(n));
}

}  // namespace

struct Spectra::Plans {
  fftwf_plan forward = nullptr, inverse = nullptr;
  std::size_t plane = 0, bins = 0;
};

Spectra::Spectra(SizePx size)
    : padded_{quickLength(size.width), quickLength(size.height)},
      plans_(std::make_unique<Plans>()) {
  Plans& p = *plans_;
  p.plane = static_cast<std::size_t>(padded_.width) * padded_.height;
  p.bins = static_cast<std::size_t>(padded_.width / 2 + 1) * padded_.height;
  const auto plane = realBuffer(p.plane);
  const auto bins = complexBuffer(p.bins);
  const std::lock_guard<std::mutex> lock(plannerMutex());
  p.forward =
      fftwf_plan_dft_r2c_2d(padded_.height, padded_.width, plane.get(), bins.get(), FFTW_ESTIMATE);
  p.inverse =
      fftwf_plan_dft_c2r_2d(padded_.height, padded_.width, bins.get(), plane.get(), FFTW_ESTIMATE);
  PATINA_CHECK(p.forward && p.inverse);
}

Spectra::~Spectra() {
  const std::lock_guard<std::mutex> lock(plannerMutex());
  fftwf_destroy_plan(plans_->forward);
  fftwf_destroy_plan(plans_->inverse);
}

// Buffers come from FFTW's own allocator, so that the alignment the plans were made for holds.
Spectra::Spectrum Spectra::forward(const std::function<void(float*)>& fill) const {
  const auto plane = realBuffer(plans_->plane);
  const auto bins = complexBuffer(plans_->bins);
  std::memset(plane.get(), 0, plans_->plane * sizeof(float));
  fill(plane.get());
  fftwf_execute_dft_r2c(plans_->forward, plane.get(), bins.get());
  const auto* first = reinterpret_cast<const std::complex<float>*>(bins.get());
  return {first, first + plans_->bins};
}

std::vector<float> Spectra::inverse(Spectrum& spectrum) const {
  PATINA_CHECK(spectrum.size() == plans_->bins);
  const auto bins = complexBuffer(plans_->bins);
  const auto plane = realBuffer(plans_->plane);
  std::memcpy(bins.get(), spectrum.data(), plans_->bins * sizeof(fftwf_complex));
  fftwf_execute_dft_c2r(plans_->inverse, bins.get(), plane.get());
  const float scale = 1.0f / static_cast<float>(plans_->plane);
  std::vector<float> out(plans_->plane);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = plane[i] * scale;
  return out;
}

}  // namespace patina::patch
