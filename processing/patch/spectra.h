// SPDX-License-Identifier: GPL-3.0-or-later
// Real two-dimensional Fourier transforms of one size (FFTW, single precision), for correlations.
#pragma once

#include <complex>
#include <functional>
#include <memory>
#include <new>
#include <span>
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
// multiple of 16, the height to one of 8. Plans are made by estimate, never by timing: the same
// machine gives the same bits. Thread-safe once made.
class Spectra {
 public:
  using Plane = std::vector<float, AlignedAllocator<float>>;
  // [columns()][height], a column's bins side by side, where they are transformed thrice as fast as
  // across rows; the last columns are padding.
  using Spectrum = std::vector<std::complex<float>, AlignedAllocator<std::complex<float>>>;
  // What a transform needs on its way: kept by who calls often, shared by nobody.
  struct Room {
    Spectrum rows_in, rows_out;
  };

  explicit Spectra(SizePx size);
  ~Spectra();
  Spectra(const Spectra&) = delete;
  Spectra& operator=(const Spectra&) = delete;

  SizePx padded() const { return padded_; }
  int columns() const { return (padded_.width / 2 + 8) / 8 * 8; }

  // Of a plane [rows][padded width]; the rows below are zero and cost less.
  void forward(std::span<const float> plane, Spectrum& out) const;
  // The plane of a spectrum, scaled back.
  void inverse(const Spectrum& spectrum, Plane& out) const;
  // Rows [0, rows_out) of factor * sum over k, i, j of planes[k](i,j) with[k](x + i, y + j), around
  // the padded size: `use(y, row)` gets each once, from many threads.
  void correlate(std::span<const Plane> planes, std::span<const Spectrum> with, float factor,
                 int rows_out, Room& room,
                 const std::function<void(int y, const float* row)>& use) const;

 private:
  struct Plans;
  std::size_t height() const { return static_cast<std::size_t>(padded_.height); }
  void rowsForward(const float* plane, int first, int end, std::complex<float>* out) const;
  void columnsForward(const std::complex<float>* rows, std::size_t count, std::size_t column,
                      float scale, std::complex<float>* out) const;
  void columnsBack(const std::complex<float>* columns, std::size_t column, std::size_t count,
                   std::complex<float>* rows) const;
  void rowsBack(std::complex<float>* rows, int count,
                const std::function<void(int y, const float* row)>& use) const;

  SizePx padded_;
  std::unique_ptr<Plans> plans_;
};

}  // namespace patina::patch
