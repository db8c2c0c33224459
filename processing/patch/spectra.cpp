// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/spectra.h"

#include <fftw3.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

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

// The least multiple of `unit` from `n` on that has no prime factor above 7.
int quickLength(int n, int unit) {
  for (n = (n + unit - 1) / unit * unit;; n += unit) {
    int rest = n;
    for (int prime : {2, 3, 5, 7})
      while (rest % prime == 0) rest /= prime;
    if (rest == 1) return n;
  }
}

fftwf_complex* raw(std::complex<float>* bins) { return reinterpret_cast<fftwf_complex*>(bins); }

constexpr int kColumns = 8;  // transformed together: a cache line of each row

}  // namespace

struct Spectra::Plans {
  fftwf_plan row = nullptr, columns = nullptr, columns_back = nullptr, row_back = nullptr;
  std::size_t plane = 0, bins = 0;
};

Spectra::Spectra(SizePx size)
    : padded_{quickLength(size.width, 16), quickLength(size.height, 1)},
      plans_(std::make_unique<Plans>()) {
  Plans& p = *plans_;
  p.plane = static_cast<std::size_t>(padded_.width) * padded_.height;
  p.bins = static_cast<std::size_t>(pitch()) * padded_.height;
  Plane plane(p.plane);
  Spectrum bins(p.bins);
  const std::lock_guard<std::mutex> lock(plannerMutex());
  p.row = fftwf_plan_dft_r2c_1d(padded_.width, plane.data(), raw(bins.data()), FFTW_ESTIMATE);
  p.row_back = fftwf_plan_dft_c2r_1d(padded_.width, raw(bins.data()), plane.data(), FFTW_ESTIMATE);
  const auto columns = [&](int sign) {
    return fftwf_plan_many_dft(1, &padded_.height, kColumns, raw(bins.data()), nullptr, pitch(), 1,
                               raw(bins.data()), nullptr, pitch(), 1, sign, FFTW_ESTIMATE);
  };
  p.columns = columns(FFTW_FORWARD);
  p.columns_back = columns(FFTW_BACKWARD);
  PATINA_CHECK(p.row && p.columns && p.columns_back && p.row_back);
}

Spectra::~Spectra() {
  const std::lock_guard<std::mutex> lock(plannerMutex());
  for (fftwf_plan plan : {plans_->row, plans_->columns, plans_->columns_back, plans_->row_back})
    fftwf_destroy_plan(plan);
}

void Spectra::forward(int rows, const std::function<void(float*)>& fill, Spectrum& out) const {
  PATINA_CHECK(rows >= 1 && rows <= padded_.height);
  const std::size_t width = pitch();
  thread_local Plane plane;
  plane.assign(static_cast<std::size_t>(rows) * padded_.width, 0.0f);
  fill(plane.data());
  out.resize(plans_->bins);
  for (int y = 0; y < rows; ++y) {
    std::complex<float>* row = out.data() + y * width;
    fftwf_execute_dft_r2c(plans_->row, plane.data() + static_cast<std::size_t>(y) * padded_.width,
                          raw(row));
    std::fill(row + padded_.width / 2 + 1, row + width, std::complex<float>());
  }
  std::fill(out.begin() + static_cast<std::ptrdiff_t>(rows * width), out.end(),
            std::complex<float>());
  for (std::size_t x = 0; x < width; x += kColumns)
    fftwf_execute_dft(plans_->columns, raw(out.data() + x), raw(out.data() + x));
}

void Spectra::inverse(Spectrum& spectrum, Plane& out) const {
  PATINA_CHECK(spectrum.size() == plans_->bins);
  out.resize(plans_->plane);
  const std::size_t width = pitch();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, width / kColumns, 2), [&](const auto& part) {
    for (std::size_t i = part.begin(); i < part.end(); ++i) {
      fftwf_complex* columns = raw(spectrum.data() + i * kColumns);
      fftwf_execute_dft(plans_->columns_back, columns, columns);
    }
  });
  const float scale = 1.0f / static_cast<float>(plans_->plane);
  tbb::parallel_for(tbb::blocked_range<int>(0, padded_.height, 32), [&](const auto& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) {
      float* row = out.data() + static_cast<std::size_t>(y) * padded_.width;
      fftwf_execute_dft_c2r(plans_->row_back, raw(spectrum.data() + y * width), row);
      for (int x = 0; x < padded_.width; ++x) row[x] *= scale;
    }
  });
}

}  // namespace patina::patch
