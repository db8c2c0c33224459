// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/spectra.h"

#include <fftw3.h>

#include <algorithm>
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

fftwf_complex* raw(Spectra::Spectrum& bins) {
  return reinterpret_cast<fftwf_complex*>(bins.data());
}

}  // namespace

struct Spectra::Plans {
  fftwf_plan row = nullptr, columns = nullptr, inverse = nullptr;
  std::size_t plane = 0, bins = 0;
};

Spectra::Spectra(SizePx size)
    : padded_{quickLength(size.width), quickLength(size.height)},
      plans_(std::make_unique<Plans>()) {
  Plans& p = *plans_;
  p.plane = static_cast<std::size_t>(padded_.width) * padded_.height;
  p.bins = static_cast<std::size_t>(padded_.width / 2 + 1) * padded_.height;
  std::vector<float> plane(p.plane);
  Spectrum bins(p.bins);
  const std::lock_guard<std::mutex> lock(plannerMutex());
  // Unaligned: any vector will do, and the same code runs wherever it lies.
  const int width = padded_.width / 2 + 1;
  p.row =
      fftwf_plan_dft_r2c_1d(padded_.width, plane.data(), raw(bins), FFTW_ESTIMATE | FFTW_UNALIGNED);
  p.columns =
      fftwf_plan_many_dft(1, &padded_.height, width, raw(bins), nullptr, width, 1, raw(bins),
                          nullptr, width, 1, FFTW_FORWARD, FFTW_ESTIMATE | FFTW_UNALIGNED);
  p.inverse = fftwf_plan_dft_c2r_2d(padded_.height, padded_.width, raw(bins), plane.data(),
                                    FFTW_ESTIMATE | FFTW_UNALIGNED);
  PATINA_CHECK(p.row && p.columns && p.inverse);
}

Spectra::~Spectra() {
  const std::lock_guard<std::mutex> lock(plannerMutex());
  fftwf_destroy_plan(plans_->row);
  fftwf_destroy_plan(plans_->columns);
  fftwf_destroy_plan(plans_->inverse);
}

void Spectra::forward(int rows, const std::function<void(float*)>& fill, Spectrum& out) const {
  PATINA_CHECK(rows >= 1 && rows <= padded_.height);
  const std::size_t width = padded_.width / 2 + 1;
  thread_local std::vector<float> plane;
  plane.assign(static_cast<std::size_t>(rows) * padded_.width, 0.0f);
  fill(plane.data());
  out.resize(plans_->bins);
  for (int y = 0; y < rows; ++y)
    fftwf_execute_dft_r2c(plans_->row, plane.data() + static_cast<std::size_t>(y) * padded_.width,
                          raw(out) + y * width);
  std::fill(out.begin() + static_cast<std::ptrdiff_t>(rows * width), out.end(),
            std::complex<float>());
  fftwf_execute_dft(plans_->columns, raw(out), raw(out));
}

void Spectra::inverse(Spectrum& spectrum, std::vector<float>& out) const {
  PATINA_CHECK(spectrum.size() == plans_->bins);
  out.resize(plans_->plane);
  fftwf_execute_dft_c2r(plans_->inverse, raw(spectrum), out.data());
  const float scale = 1.0f / static_cast<float>(plans_->plane);
  for (float& v : out) v *= scale;
}

}  // namespace patina::patch
