// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/spectra.h"

#include <fftw3.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif
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
constexpr int kRows = 16;    // of a task

// sum += f * conj(t), `count` a multiple of 8. Only bounds hang on it, so paths may round apart.
using AddProduct = void (*)(const std::complex<float>* f, const std::complex<float>* t,
                            std::size_t count, std::complex<float>* sum);
void addProductPlain(const std::complex<float>* f, const std::complex<float>* t, std::size_t count,
                     std::complex<float>* sum) {
  const float *u = reinterpret_cast<const float*>(f), *v = reinterpret_cast<const float*>(t);
  float* out = reinterpret_cast<float*>(sum);
  for (std::size_t i = 0; i < 2 * count; i += 2) {
    out[i] += u[i] * v[i] + u[i + 1] * v[i + 1];
    out[i + 1] += u[i + 1] * v[i] - u[i] * v[i + 1];
  }
}
#if defined(__x86_64__)
[[gnu::target("avx2,fma")]] void addProductAvx2(const std::complex<float>* f,
                                                const std::complex<float>* t, std::size_t count,
                                                std::complex<float>* sum) {
  const float *u = reinterpret_cast<const float*>(f), *v = reinterpret_cast<const float*>(t);
  float* out = reinterpret_cast<float*>(sum);
  for (std::size_t i = 0; i < 2 * count; i += 8) {
    const __m256 a = _mm256_loadu_ps(u + i), b = _mm256_loadu_ps(v + i);
    const __m256 crossed = _mm256_mul_ps(_mm256_permute_ps(a, 0xb1), _mm256_movehdup_ps(b));
    const __m256 product = _mm256_fmsubadd_ps(a, _mm256_moveldup_ps(b), crossed);
    _mm256_storeu_ps(out + i, _mm256_add_ps(_mm256_loadu_ps(out + i), product));
  }
}
const AddProduct addProduct = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
                                  ? addProductAvx2
                                  : addProductPlain;
#else
const AddProduct addProduct = addProductPlain;
#endif

}  // namespace

struct Spectra::Plans {
  fftwf_plan row = nullptr, columns = nullptr, columns_back = nullptr, row_back = nullptr;
};

Spectra::Spectra(SizePx size)
    : padded_{quickLength(size.width, 16), quickLength(size.height, 8)},
      plans_(std::make_unique<Plans>()) {
  Plans& p = *plans_;
  Plane plane(padded_.width);
  Spectrum bins(std::max<std::size_t>(columns(), kColumns * height())), other(bins.size());
  const std::lock_guard<std::mutex> lock(plannerMutex());
  p.row = fftwf_plan_dft_r2c_1d(padded_.width, plane.data(), raw(bins.data()), FFTW_ESTIMATE);
  p.row_back = fftwf_plan_dft_c2r_1d(padded_.width, raw(bins.data()), plane.data(), FFTW_ESTIMATE);
  const auto columns = [&](int sign) {
    return fftwf_plan_many_dft(1, &padded_.height, kColumns, raw(bins.data()), nullptr, 1,
                               padded_.height, raw(other.data()), nullptr, 1, padded_.height, sign,
                               FFTW_ESTIMATE);  // in place it would copy them twice
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

void Spectra::rowsForward(const float* plane, int first, int end, std::complex<float>* out) const {
  for (int y = first; y < end; ++y) {
    std::complex<float>* row = out + static_cast<std::ptrdiff_t>(y) * columns();
    // FFTW does not write to what r2c reads.
    fftwf_execute_dft_r2c(
        plans_->row, const_cast<float*>(plane) + static_cast<std::ptrdiff_t>(y) * padded_.width,
        raw(row));
    std::fill(row + padded_.width / 2 + 1, row + columns(), std::complex<float>());
  }
}

void Spectra::columnsForward(const std::complex<float>* rows, std::size_t count, std::size_t column,
                             float scale, std::complex<float>* out) const {
  thread_local Spectrum columns_in;
  columns_in.resize(kColumns * height());
  std::complex<float>* in = columns_in.data();
  for (std::size_t y = 0; y < count; ++y)
    for (std::size_t x = 0; x < kColumns; ++x)
      in[x * height() + y] = scale * rows[y * columns() + column + x];
  for (std::size_t x = 0; x < kColumns; ++x)
    std::fill(in + x * height() + count, in + (x + 1) * height(), std::complex<float>());
  fftwf_execute_dft(plans_->columns, raw(in), raw(out));
}

void Spectra::columnsBack(const std::complex<float>* columns_in, std::size_t column,
                          std::size_t count, std::complex<float>* rows) const {
  thread_local Spectrum columns_out;
  columns_out.resize(kColumns * height());
  const std::complex<float>* out = columns_out.data();
  // FFTW keeps what such a plan reads.
  fftwf_execute_dft(plans_->columns_back, raw(const_cast<std::complex<float>*>(columns_in)),
                    raw(columns_out.data()));
  for (std::size_t y = 0; y < count; ++y)
    for (std::size_t x = 0; x < kColumns; ++x)
      rows[y * columns() + column + x] = out[x * height() + y];
}

void Spectra::rowsBack(std::complex<float>* rows, int count,
                       const std::function<void(int y, const float* row)>& use) const {
  tbb::parallel_for(tbb::blocked_range<int>(0, count, kRows), [&](const auto& part) {
    thread_local Plane row;
    row.resize(padded_.width);
    for (int y = part.begin(); y < part.end(); ++y) {
      fftwf_execute_dft_c2r(plans_->row_back,
                            raw(rows + static_cast<std::ptrdiff_t>(y) * columns()), row.data());
      use(y, row.data());
    }
  });
}

void Spectra::forward(std::span<const float> plane, Spectrum& out) const {
  const std::size_t width = columns(), rows = plane.size() / padded_.width;
  PATINA_CHECK(rows >= 1 && rows <= height() && plane.size() == rows * padded_.width);
  thread_local Spectrum of_rows;
  of_rows.resize(rows * width);
  rowsForward(plane.data(), 0, static_cast<int>(rows), of_rows.data());
  out.resize(width * height());
  for (std::size_t x = 0; x < width; x += kColumns)
    columnsForward(of_rows.data(), rows, x, 1, out.data() + x * height());
}

void Spectra::inverse(const Spectrum& spectrum, Plane& out) const {
  const std::size_t width = columns();
  PATINA_CHECK(spectrum.size() == width * height());
  Spectrum rows(spectrum.size());
  tbb::parallel_for(std::size_t{0}, width / kColumns, [&](std::size_t i) {
    columnsBack(spectrum.data() + i * kColumns * height(), i * kColumns, height(), rows.data());
  });
  out.resize(static_cast<std::size_t>(padded_.width) * height());
  const float scale = 1.0f / static_cast<float>(out.size());
  rowsBack(rows.data(), padded_.height, [&](int y, const float* row) {
    float* to = out.data() + static_cast<std::ptrdiff_t>(y) * padded_.width;
    for (int x = 0; x < padded_.width; ++x) to[x] = row[x] * scale;
  });
}

void Spectra::correlate(std::span<const Plane> planes, std::span<const Spectrum> with, float factor,
                        int rows_out, Room& room,
                        const std::function<void(int y, const float* row)>& use) const {
  const std::size_t width = columns(), rows = planes.front().size() / padded_.width;
  PATINA_CHECK(planes.size() == with.size() && rows >= 1 && rows <= height() && rows_out >= 1 &&
               rows_out <= padded_.height);
  room.rows_in.resize(planes.size() * rows * width);
  room.rows_out.resize(rows_out * width);
  const int parts = static_cast<int>((rows + kRows - 1) / kRows);
  tbb::parallel_for(0, parts * static_cast<int>(planes.size()), [&](int task) {
    const std::size_t k = task / parts;
    const int first = task % parts * kRows;
    rowsForward(planes[k].data(), first, std::min(first + kRows, static_cast<int>(rows)),
                room.rows_in.data() + k * rows * width);
  });
  const float scale = factor / (static_cast<float>(padded_.width) * padded_.height);
  const std::size_t block = kColumns * height();
  tbb::parallel_for(std::size_t{0}, width / kColumns, [&](std::size_t i) {
    thread_local Spectrum column, sum;
    column.resize(block);
    sum.assign(block, {});
    for (std::size_t k = 0; k < planes.size(); ++k) {
      columnsForward(room.rows_in.data() + k * rows * width, rows, i * kColumns, scale,
                     column.data());
      addProduct(with[k].data() + i * block, column.data(), block, sum.data());
    }
    columnsBack(sum.data(), i * kColumns, rows_out, room.rows_out.data());
  });
  rowsBack(room.rows_out.data(), rows_out, use);
}

}  // namespace patina::patch
