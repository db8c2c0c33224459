// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/mosaic_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "processing/image/cv_bridge.h"
#include "processing/image/linear_mosaic.h"

namespace patina::calibration {
namespace {

constexpr int kReach_px = 3, kAcross = 2 * kReach_px, kTaps = kAcross * kAcross;
constexpr int kAround_px = 65, kBlockPx = 16, kSteps = 12;
constexpr int kSum_px = 4;          // of a side: what stands out is looked for in sums
constexpr double kStandsOut = 50;   // chi squared of three colours
constexpr int kGrow_px = 3;         // its flanks tell where it is
constexpr double kSpeck = 20;       // variance of what is a speck, over the noise
constexpr double kLength_px = 1.4;  // of the covariance
constexpr double kProbe_px = 0.08, kDone_px = 0.002, kMostStep_px = 0.3, kSlope_px = 0.1;

using Covariance = std::array<std::array<double, 3>, 3>;

// A picture's photosites over the mean of their colour around, less one.
struct Relative {
  cv::Mat ratio;
  std::array<double, 3> noise{};  // variance
  cv::Mat stands_out;             // 255: something is to be seen here
};

cv::Mat onesOf(const Photosites& sites, int colour) {
  cv::Mat out(sites.samples.height(), sites.samples.width(), CV_32F);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x)
      out.at<float>(y, x) = sites.colourAt(x, y) == colour ? 1.0f : 0.0f;
  return out;
}

cv::Mat sumAround(const cv::Mat& in, int side_px) {
  cv::Mat out;
  cv::boxFilter(in, out, CV_32F, {side_px, side_px}, {-1, -1}, false, cv::BORDER_REFLECT_101);
  return out;
}

// Of second differences between a colour's own pixels; by their median, which specks do not move.
double noiseOf(const Photosites& sites, const cv::Mat& ratio, int colour) {
  std::vector<float> sizes;
  for (int y = 0; y < ratio.rows; ++y)
    for (int x = 2; x + 2 < ratio.cols; ++x)
      if (sites.colourAt(x, y) == colour) {
        const auto* r = ratio.ptr<float>(y) + x;
        sizes.push_back(std::abs(r[-2] - 2 * r[0] + r[2]));
      }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const double spread = 1.4826 * *middle;
  return std::max(spread * spread / 6, 1e-10);
}

Relative relativeOf(const PreparedPicture& picture) {
  const Photosites& sites = picture.photosites;
  const cv::Mat samples = asMat(sites.samples.view());
  Relative out;
  out.ratio = cv::Mat(samples.size(), CV_32F, cv::Scalar(0));
  cv::Mat chi_squared(samples.size(), CV_32F, cv::Scalar(0));
  for (int c = 0; c < 3; ++c) {
    const cv::Mat own = onesOf(sites, c);
    cv::Mat ratio;
    cv::divide(sumAround(samples.mul(own), kAround_px), sumAround(own, kAround_px), ratio);
    cv::divide(samples, cv::max(ratio, 1e-9), ratio);
    ratio = (ratio - 1).mul(own);
    out.noise[static_cast<std::size_t>(c)] = noiseOf(sites, ratio, c);
    out.ratio += ratio;
    const cv::Mat sum = sumAround(ratio, kSum_px);
    cv::Mat part;
    cv::divide(sum.mul(sum), sumAround(own, kSum_px), part,
               1 / out.noise[static_cast<std::size_t>(c)]);
    chi_squared += part;
  }
  const int side = 2 * kGrow_px + 1;
  cv::dilate(chi_squared > kStandsOut, out.stands_out, cv::Mat::ones(side, side, CV_8U));
  if (!picture.levels[0].usable.empty())
    cv::bitwise_and(out.stands_out, asMat(picture.levels[0].usable.view()), out.stands_out);
  return out;
}

// What the colours have in common where something stands out.
Covariance covarianceOf(const Relative& seen, const Photosites& sites) {
  Image<float> ratio(seen.ratio.cols, seen.ratio.rows, 1);
  cv::Mat to = asMat(ratio.view());
  seen.ratio.copyTo(to);
  const Image<float> colours = demosaicLinear(std::as_const(ratio).view(), sites.cfa);
  Covariance out{};
  const int count = cv::countNonZero(seen.stands_out);
  for (int y = 0; y < ratio.height(); ++y)
    for (int x = 0; x < ratio.width(); ++x) {
      if (!seen.stands_out.at<std::uint8_t>(y, x)) continue;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          out[i][j] += static_cast<double>(colours.at(x, y, static_cast<int>(i))) *
                       colours.at(x, y, static_cast<int>(j)) / count;
    }
  for (std::size_t i = 0; i < 3; ++i) out[i][i] *= 1.01;  // colours are not quite of one piece
  return out;
}

// Weights of kTaps photosites, and the variance of what they predict, noise included.
struct Kernel {
  cv::Mat weights;
  double variance = 0;
};

// Of one picture from the other's photosites.
class Kriging {
 public:
  Kriging(const Photosites& from, const Covariance& prior, const std::array<double, 3>& noise)
      : from_(from), prior_(prior), noise_(noise) {
    for (int parity = 0; parity < 4; ++parity) {
      cv::Mat system(kTaps, kTaps, CV_64F);
      for (int i = 0; i < kTaps; ++i)
        for (int j = 0; j < kTaps; ++j) {
          const std::size_t a = colourOf(i, parity), b = colourOf(j, parity);
          system.at<double>(i, j) =
              prior[a][b] * fallOff(xOf(i) - xOf(j), yOf(i) - yOf(j)) + (i == j ? noise[a] : 0);
        }
      cv::invert(system, inverse_[static_cast<std::size_t>(parity)], cv::DECOMP_CHOLESKY);
    }
  }

  // Of `colour` at (x + fx, y + fy), 0 <= f < 1; its first photosite is (x, y) - (reach - 1).
  Kernel at(int x, int y, double fx, double fy, std::size_t colour) const {
    const int parity = (y & 1) * 2 + (x & 1);
    cv::Mat towards(kTaps, 1, CV_64F);
    for (int i = 0; i < kTaps; ++i)
      towards.at<double>(i) =
          prior_[colour][colourOf(i, parity)] * fallOff(fx - xOf(i), fy - yOf(i));
    Kernel out;
    out.weights = inverse_[static_cast<std::size_t>(parity)] * towards;
    out.variance = prior_[colour][colour] - out.weights.dot(towards) + noise_[colour];
    return out;
  }

 private:
  static double xOf(int tap) { return tap % kAcross - kReach_px + 1; }
  static double yOf(int tap) {
    const int row = tap / kAcross;
    return row - kReach_px + 1;
  }
  static double fallOff(double x, double y) {
    constexpr double kRound_px = 0.5;  // no cusp: a photosite has an area
    return std::exp((kRound_px - std::sqrt(x * x + y * y + kRound_px * kRound_px)) / kLength_px);
  }
  std::size_t colourOf(int tap, int parity) const {
    constexpr int kEven = 2 * kReach_px;
    return static_cast<std::size_t>(
        from_.colourAt(kEven + static_cast<int>(xOf(tap)) + (parity & 1),
                       kEven + static_cast<int>(yOf(tap)) + parity / 2));
  }

  const Photosites& from_;
  Covariance prior_;
  std::array<double, 3> noise_;
  std::array<cv::Mat, 4> inverse_;
};

// One of the two ways: what is predicted of `to`.
struct Way {
  const Relative& from;
  const Relative& to;
  const Photosites& to_sites;
  Kriging kriging;
  double sign;  // of the shift that takes a place of `to` into `from`
};

constexpr int kProbes = 6;
using Probed = std::array<double, kProbes>;  // at s, s +- x, s +- y, s + x + y

// -log of the likelihood, block by block of `to`.
void addCosts(const Way& way, double sx, double sy, std::size_t probe, int columns,
              std::vector<Probed>& blocks) {
  const double tx = way.sign * sx, ty = way.sign * sy;
  const int dx = static_cast<int>(std::floor(tx)), dy = static_cast<int>(std::floor(ty));
  std::array<Kernel, 4> kernels;
  for (int k = 0; k < 4; ++k)
    kernels[static_cast<std::size_t>(k)] =
        way.kriging.at((k & 1) + dx, k / 2 + dy, tx - dx, ty - dy,
                       static_cast<std::size_t>(way.to_sites.colourAt(k & 1, k / 2)));
  const cv::Mat &from = way.from.ratio, &to = way.to.ratio;
  const int x_first = std::max(0, kReach_px - 1 - dx), y_first = std::max(0, kReach_px - 1 - dy),
            x_end = std::min(to.cols, from.cols - kReach_px - dx),
            y_end = std::min(to.rows, from.rows - kReach_px - dy);
  for (int y = y_first; y < y_end; ++y)
    for (int x = x_first; x < x_end; ++x) {
      if (!way.to.stands_out.at<std::uint8_t>(y, x)) continue;
      const Kernel& kernel = kernels[placeInCell(x, y)];
      const auto* weight = kernel.weights.ptr<double>();
      double residual = to.at<float>(y, x);
      for (int j = 0; j < kAcross; ++j) {
        const auto* row = from.ptr<float>(y + dy + j - kReach_px + 1) + x + dx - kReach_px + 1;
        for (int i = 0; i < kAcross; ++i) residual -= *weight++ * row[i];
      }
      const auto block =
          static_cast<std::size_t>(y / kBlockPx) * static_cast<std::size_t>(columns) +
          static_cast<std::size_t>(x / kBlockPx);
      blocks[block][probe] +=
          0.5 * (residual * residual / kernel.variance + std::log(kernel.variance));
    }
}

struct Curve {  // gradient and Hessian
  double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  explicit Curve(const Probed& f)
      : x((f[1] - f[2]) / (2 * kProbe_px)),
        y((f[3] - f[4]) / (2 * kProbe_px)),
        xx((f[1] + f[2] - 2 * f[0]) / (kProbe_px * kProbe_px)),
        xy((f[5] - f[1] - f[3] + f[0]) / (kProbe_px * kProbe_px)),
        yy((f[3] + f[4] - 2 * f[0]) / (kProbe_px * kProbe_px)) {}
  bool isBowl() const { return xx > 0 && yy > 0 && xx * yy - xy * xy > 0.01 * xx * yy; }
  // Of Newton; beside a bowl, down the slope.
  PlacePx step() const {
    if (!isBowl()) {
      const double downhill = -kSlope_px / std::max(std::hypot(x, y), 1e-12);
      return {downhill * x, downhill * y};
    }
    const double determinant = xx * yy - xy * xy;
    return {(xy * y - yy * x) / determinant, (xy * x - xx * y) / determinant};
  }
};

Probed less(const Probed& all, const Probed& part) {
  Probed out;
  for (std::size_t k = 0; k < kProbes; ++k) out[k] = all[k] - part[k];
  return out;
}

// By leaving out one block after the other; at the least of the sum.
double uncertaintyOf(const std::vector<Probed>& blocks, const Probed& sum) {
  double squares = 0;
  const PlacePx whole = Curve(sum).step();
  for (const Probed& block : blocks) {
    if (block[0] == 0) continue;
    const Curve others(less(sum, block));
    if (!others.isBowl()) return std::numeric_limits<double>::infinity();
    const PlacePx step = others.step();
    squares += (step.x - whole.x) * (step.x - whole.x) + (step.y - whole.y) * (step.y - whole.y);
  }
  return squares > 0 ? std::sqrt(squares) : std::numeric_limits<double>::infinity();
}

std::vector<Probed> probed(const Way& forth, const Way& back, double sx, double sy) {
  const auto across = [](int px) { return (px + kBlockPx - 1) / kBlockPx; };
  const int columns = std::max(across(forth.to.ratio.cols), across(back.to.ratio.cols)),
            rows = std::max(across(forth.to.ratio.rows), across(back.to.ratio.rows));
  std::vector<Probed> blocks(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  constexpr std::array<PlacePx, kProbes> kPlaces{
      {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}}};
  for (std::size_t k = 0; k < kProbes; ++k)
    for (const Way* way : {&forth, &back})
      addCosts(*way, sx + kProbe_px * kPlaces[k].x, sy + kProbe_px * kPlaces[k].y, k, columns,
               blocks);
  return blocks;
}

void leaveOutWhatDisagrees(const Agreement& agreement, cv::Mat& stands_out) {
  const int side = agreement.block_px << agreement.level;
  for (int y = 0; y < stands_out.rows; ++y)
    for (int x = 0; x < stands_out.cols; ++x)
      if (agreement.blocks.at(std::min(x / side, agreement.blocks.width() - 1),
                              std::min(y / side, agreement.blocks.height() - 1)) ==
          BlockState::kDisagrees)
        stands_out.at<std::uint8_t>(y, x) = 0;
}

}  // namespace

MosaicShift refineByPhotosites(const PreparedPicture& reference, const PreparedPicture& frame,
                               const Motion& start, const Agreement& agreement) {
  MosaicShift out{start, std::numeric_limits<double>::infinity()};
  if (reference.photosites.empty() || frame.photosites.empty()) return out;
  Relative own = relativeOf(reference);
  const Relative seen = relativeOf(frame);
  leaveOutWhatDisagrees(agreement, own.stands_out);
  if (cv::countNonZero(own.stands_out) == 0 || cv::countNonZero(seen.stands_out) == 0) return out;
  const Covariance prior = covarianceOf(own, reference.photosites);
  std::array<double, 3> noise{};
  bool specks = false;
  for (std::size_t c = 0; c < 3; ++c) {
    noise[c] = (own.noise[c] + seen.noise[c]) / 2;
    specks |= prior[c][c] > kSpeck * noise[c];
  }
  if (!specks) return out;  // waves that rise above the noise in sums alone
  const Way forth{own, seen, frame.photosites, {reference.photosites, prior, noise}, -1},
      back{seen, own, reference.photosites, {frame.photosites, prior, noise}, 1};
  double x = start[2], y = start[5];
  for (int step = 0; step < kSteps; ++step) {
    const std::vector<Probed> blocks = probed(forth, back, x, y);
    Probed sum{};
    for (const Probed& block : blocks)
      for (std::size_t k = 0; k < kProbes; ++k) sum[k] += block[k];
    const PlacePx by = Curve(sum).step();
    x += std::clamp(by.x, -kMostStep_px, kMostStep_px);
    y += std::clamp(by.y, -kMostStep_px, kMostStep_px);
    out.uncertainty_px = uncertaintyOf(blocks, sum);
    if (std::hypot(by.x, by.y) < kDone_px) break;
  }
  out.frame_from_reference[2] = x, out.frame_from_reference[5] = y;
  return out;
}

}  // namespace patina::calibration
