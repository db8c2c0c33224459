// SPDX-License-Identifier: GPL-3.0-or-later
// Real two-dimensional Fourier transforms of one size (FFTW, single precision), for correlations.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <new>
#include <vector>

#include "processing/image/units.h"

namespace patina::patch {

// Where SIMD codelets can load from.
template <class T>
struct AlignedAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};
  AlignedAllocator() = default;
  template <class U>
  explicit AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kAlignment)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, kAlignment); }
  bool operator==(const AlignedAllocator&) const { return true; }
};

// Transforms of planes of at least `size`, rounded up to lengths that are quick, the width to a
// multiple of 16. Plans are made by estimate, never by timing: the same machine gives the same
// bits. Thread-safe once made.
class Spectra {
 public:
  using Plane = std::vector<float, AlignedAllocator<float>>;
  // [height][pitch()]; the last columns are padding.
  using Spectrum = std::vector<std::complex<float>, AlignedAllocator<std::complex<float>>>;

  explicit Spectra(SizePx size);
  ~Spectra();
  Spectra(const Spectra&) = delete;
  Spectra& operator=(const Spectra&) = delete;

  SizePx padded() const { return padded_; }
  int pitch() const { return padded_.width / 2 + 8; }
  // `fill` gets a zeroed plane [rows][width] of the padded width; rows below are zero (and cost
  // half). Both reuse what `out` holds.
  void forward(int rows, const std::function<void(float* plane)>& fill, Spectrum& out) const;
  // The plane of a spectrum, scaled back; the spectrum is destroyed. Multi-threaded.
  void inverse(Spectrum& spectrum, Plane& out) const;

 private:
  struct Plans;
  SizePx padded_;
  std::unique_ptr<Plans> plans_;
};

}  // namespace patina::patch
