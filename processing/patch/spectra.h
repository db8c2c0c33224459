// SPDX-License-Identifier: GPL-3.0-or-later
// Real two-dimensional Fourier transforms of one size (FFTW, single precision), for correlations.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "processing/image/units.h"

namespace patina::patch {

// Transforms of planes of at least `size`, rounded up to lengths that are quick. Plans are made by
// estimate, never by timing: the same machine gives the same bits. Thread-safe once made.
class Spectra {
 public:
  using Spectrum = std::vector<std::complex<float>>;  // [height][width / 2 + 1]

  explicit Spectra(SizePx size);
  ~Spectra();
  Spectra(const Spectra&) = delete;
  Spectra& operator=(const Spectra&) = delete;

  SizePx padded() const { return padded_; }
  // `fill` gets a zeroed plane [rows][width] of the padded width; rows below are zero (and cost
  // half). Both reuse what `out` holds.
  void forward(int rows, const std::function<void(float* plane)>& fill, Spectrum& out) const;
  // The plane of a spectrum, scaled back; the spectrum is destroyed.
  void inverse(Spectrum& spectrum, std::vector<float>& out) const;

 private:
  struct Plans;
  SizePx padded_;
  std::unique_ptr<Plans> plans_;
};

}  // namespace patina::patch
