// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "processing/image/cv_bridge.h"
#include "processing/image/parallel_rows.h"

namespace patina::calibration {
namespace {

constexpr int kBlockPx = 16, kLongestSidePx = 640, kCellPx = 4;
constexpr double kAgrees = 0.5;      // ZNCC of a block
constexpr double kStructure = 0.15;  // mean square of `local` in a block that has structure
constexpr double kOff = 0.6, kOffShare = 0.03;  // log of a factor of 1.8; of a block's pixels
constexpr double kLightApart = 0.262;           // log 1.3

struct Laid {  // the frame's values where the reference has its own
  cv::Mat local, light, inside;
};

Laid layOver(const PictureLevel& frame, const Motion& motion, SizePx size) {
  const cv::Mat matrix(3, 3, CV_64F, const_cast<double*>(motion.data()));
  const cv::Size to(size.width, size.height);
  const auto warped = [&](const Image<float>& from) {
    cv::Mat out;
    cv::warpPerspective(asMat(from.view()), out, matrix, to,
                        cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    return out;
  };
  Laid laid{warped(frame.local), warped(frame.log_light), {}};
  const cv::Mat whole(frame.local.height(), frame.local.width(), CV_8U, cv::Scalar(255));
  cv::warpPerspective(whole, laid.inside, matrix, to, cv::INTER_NEAREST | cv::WARP_INVERSE_MAP);
  return laid;
}

// Of one thing on another, from sums.
struct Slope {
  double own = 0, seen = 0, both = 0;

  void add(const Slope& other) { own += other.own, seen += other.seen, both += other.both; }
  double correlation() const { return both / std::sqrt(std::max(own * seen, 1e-20)); }
};

// Log light of a cell of kCellPx: what varies inside of it is fine, what varies between the cells
// of a block is coarse.
struct Cell {
  int pixels = 0;
  double own = 0, seen = 0;
  Slope squares;

  void add(double r, double f) {
    ++pixels;
    own += r, seen += f;
    squares.own += r * r, squares.seen += f * f, squares.both += r * f;
  }
  Slope within() const {
    return {squares.own - own * own / pixels, squares.seen - seen * seen / pixels,
            squares.both - own * seen / pixels};
  }
};

struct BlockSums {
  int pixels = 0, off = 0;                      // off: lighter or darker by a factor of kOff
  double rr = 0, ff = 0, rf = 0;                // of `local`
  Slope fine, coarse;                           // of log light
  double light = 0;                             // frame over reference, log
  double xx = 0, xy = 0, yy = 0, x = 0, y = 0;  // of a step of Gauss-Newton
  // Its matrix once more, by gradients of the reference times those of the frame: noise is in both
  // but not the same in both, so what is left is structure.
  double sxx = 0, sxy = 0, syy = 0;

  double zncc() const { return rf / std::sqrt(std::max(rr * ff, 1e-20)); }
  bool isOff() const { return off > kOffShare * pixels; }
  bool hasStructure() const { return std::max(rr, 0.5 * ff) > kStructure * pixels; }
  // How far the frame's block still lies aside; negative when it cannot be told.
  double asidePx() const {
    const double trace = xx + yy, determinant = xx * yy - xy * xy;
    if (!(determinant > 0.01 * trace * trace)) return -1;
    return std::hypot(yy * x - xy * y, xx * y - xy * x) / determinant;
  }
};

void addContrast(const PictureLevel& reference, const Laid& laid, const RectPx& block,
                 BlockSums& s) {
  Cell cells;  // their means
  for (int cy = block.y; cy < block.y + block.height; cy += kCellPx)
    for (int cx = block.x; cx < block.x + block.width; cx += kCellPx) {
      Cell cell;
      for (int y = cy; y < std::min(cy + kCellPx, reference.size().height); ++y) {
        const float* own = std::as_const(reference.log_light).view().row(y);
        const auto* seen = laid.light.ptr<float>(y);
        const auto* inside = laid.inside.ptr<std::uint8_t>(y);
        for (int x = cx; x < std::min(cx + kCellPx, reference.size().width); ++x)
          if (inside[x] && (reference.usable.empty() || reference.usable.at(x, y)))
            cell.add(own[x], seen[x]);
      }
      if (cell.pixels < kCellPx * kCellPx) continue;
      s.fine.add(cell.within());
      cells.add(cell.own / cell.pixels, cell.seen / cell.pixels);
    }
  if (cells.pixels > 1) s.coarse.add(cells.within());
}

double medianOf(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// How much lighter the frame is, log: the median of every fourth pixel of every fourth row.
double lighterOverall(const PictureLevel& reference, const Laid& laid) {
  std::vector<double> values;
  for (int y = 0; y < reference.size().height; y += 4)
    for (int x = 0; x < reference.size().width; x += 4)
      if (laid.inside.at<std::uint8_t>(y, x) &&
          (reference.usable.empty() || reference.usable.at(x, y)))
        values.push_back(laid.light.at<float>(y, x) - reference.log_light.at(x, y));
  return medianOf(values);
}

BlockSums sumsOf(const PictureLevel& reference, const Laid& laid, const RectPx& block,
                 double overall) {
  BlockSums s;
  const ImageView<const float> local = reference.local.view(), light = reference.log_light.view();
  for (int y = std::max(1, block.y); y < std::min(block.y + block.height, local.height - 1); ++y) {
    const float *r = local.row(y), *up = local.row(y - 1), *down = local.row(y + 1);
    const auto *f = laid.local.ptr<float>(y), *l = laid.light.ptr<float>(y);
    const auto *f_up = laid.local.ptr<float>(y - 1), *f_down = laid.local.ptr<float>(y + 1);
    const auto* inside = laid.inside.ptr<std::uint8_t>(y);
    for (int x = std::max(1, block.x); x < std::min(block.x + block.width, local.width - 1); ++x) {
      if (!inside[x] || (!reference.usable.empty() && !reference.usable.at(x, y))) continue;
      const double own = r[x], seen = f[x];
      const double gx = 0.5 * (r[x + 1] - r[x - 1]), gy = 0.5 * (down[x] - up[x]);
      ++s.pixels;
      s.rr += own * own, s.ff += seen * seen, s.rf += own * seen;
      const double lighter = l[x] - light.at(x, y);
      s.light += lighter;
      if (std::abs(lighter - overall) > kOff) ++s.off;
      s.xx += gx * gx, s.xy += gx * gy, s.yy += gy * gy;
      s.x += gx * (seen - own), s.y += gy * (seen - own);
      const double fx = 0.5 * (f[x + 1] - f[x - 1]), fy = 0.5 * (f_down[x] - f_up[x]);
      s.sxx += gx * fx, s.sxy += 0.5 * (gx * fy + gy * fx), s.syy += gy * fy;
    }
  }
  addContrast(reference, laid, block, s);
  return s;
}

std::vector<BlockSums> blockSumsOf(const PreparedPicture& reference, const PreparedPicture& frame,
                                   const Motion& motion, int level, SizePx blocks) {
  const auto at = static_cast<std::size_t>(level);
  const PictureLevel& own = reference.levels[at];
  const Laid laid = layOver(frame.levels[at], atLevel(motion, level), own.size());
  const double overall = lighterOverall(own, laid);
  std::vector<BlockSums> sums(static_cast<std::size_t>(blocks.width) * blocks.height);
  forEachRow(blocks.height, std::int64_t{64} * own.size().width, [&](int by) {
    for (int bx = 0; bx < blocks.width; ++bx)
      sums[static_cast<std::size_t>(by) * blocks.width + bx] =
          sumsOf(own, laid, {bx * kBlockPx, by * kBlockPx, kBlockPx, kBlockPx}, overall);
  });
  return sums;
}

// By leaving out one agreeing block after the other (Miller, "The jackknife", 1974): where a few
// blocks say nearly all, each of them is missed.
double uncertaintyOf(const std::vector<BlockSums>& sums, const Image<BlockState>& states) {
  double xx = 0, xy = 0, yy = 0;
  const auto agrees = [&](std::size_t k) { return states.texels()[k] == BlockState::kAgrees; };
  for (std::size_t k = 0; k < sums.size(); ++k)
    if (agrees(k)) xx += sums[k].sxx, xy += sums[k].sxy, yy += sums[k].syy;
  double squares = 0;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    if (!agrees(k)) continue;
    const BlockSums& s = sums[k];
    const double a = xx - s.sxx, b = xy - s.sxy, c = yy - s.syy, determinant = a * c - b * b;
    if (!(determinant > 1e-6 * (a + c) * (a + c))) return std::numeric_limits<double>::infinity();
    const double x = (c * s.x - b * s.y) / determinant, y = (a * s.y - b * s.x) / determinant;
    squares += x * x + y * y;
  }
  return std::sqrt(squares);
}

// Of the frame over the reference, where blocks agree. The frame's noise has no part in it, the
// reference's has: where little but noise is left, nothing is said.
void compareContrast(const std::vector<BlockSums>& sums, Agreement& out) {
  constexpr double kLeastCorrelation = 0.5;
  Slope fine, coarse;
  for (std::size_t k = 0; k < sums.size(); ++k)
    if (out.blocks.texels()[k] == BlockState::kAgrees)
      fine.add(sums[k].fine), coarse.add(sums[k].coarse);
  out.contrast_coarse = coarse.own > 0 ? coarse.both / coarse.own : 1;
  out.contrast_fine = fine.own > 0 && fine.correlation() > kLeastCorrelation ? fine.both / fine.own
                                                                             : out.contrast_coarse;
}

// What a block must reach: less than usual where noise is half of everything.
double leastZncc(const std::vector<BlockSums>& sums, int least_pixels) {
  std::vector<double> values;
  for (const BlockSums& s : sums)
    if (s.pixels >= least_pixels && s.hasStructure()) values.push_back(s.zncc());
  return std::clamp(0.6 * medianOf(values), 0.25, kAgrees);
}

// Something dark and small is in the picture; where many blocks are off, fog or blur has taken
// their contrast.
bool fewAreOff(const std::vector<BlockSums>& sums, int least_pixels) {
  constexpr double kFew = 0.02;  // less than what counts as covered
  int judged = 0, off = 0;
  for (const BlockSums& s : sums) {
    if (s.pixels < least_pixels) continue;
    ++judged;
    if (s.isOff()) ++off;
  }
  return off <= kFew * judged;
}

void judge(const std::vector<BlockSums>& sums, int least_pixels, Agreement& out) {
  std::vector<double> lights, aside;
  for (const BlockSums& s : sums)
    if (s.pixels >= least_pixels) lights.push_back(s.light / s.pixels);
  const double light = medianOf(lights), least_zncc = leastZncc(sums, least_pixels);
  const bool few = fewAreOff(sums, least_pixels);
  double rr = 0, ff = 0, rf = 0;
  int agreeing = 0;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    const BlockSums& s = sums[k];
    if (s.pixels < least_pixels) continue;
    const bool structured = s.hasStructure();
    const bool agrees =
        (!few || !s.isOff()) &&
        (structured ? s.zncc() >= least_zncc : std::abs(s.light / s.pixels - light) < kLightApart);
    out.blocks.texels()[k] = agrees ? BlockState::kAgrees : BlockState::kDisagrees;
    ++out.judged_blocks;
    if (agrees) ++agreeing;
    if (!structured) continue;
    rr += s.rr, ff += s.ff, rf += s.rf;
    if (const double px = s.asidePx(); agrees && px >= 0) aside.push_back(px);
  }
  out.zncc = rf / std::sqrt(std::max(rr * ff, 1e-20));
  out.share = out.judged_blocks > 0 ? static_cast<double>(agreeing) / out.judged_blocks : 0;
  out.residual_px = medianOf(aside) * (1 << out.level);
}

}  // namespace

Agreement agreementOf(const PreparedPicture& reference, const PreparedPicture& frame,
                      const Motion& frame_from_reference) {
  const int levels = static_cast<int>(std::min(reference.levels.size(), frame.levels.size()));
  Agreement out;
  const auto longest = [&](int level) {
    const SizePx size = reference.levels[static_cast<std::size_t>(level)].size();
    return std::max(size.width, size.height);
  };
  while (out.level + 1 < levels && longest(out.level) > kLongestSidePx) ++out.level;
  const SizePx size = reference.levels[static_cast<std::size_t>(out.level)].size();
  out.block_px = kBlockPx;
  const SizePx blocks{(size.width + kBlockPx - 1) / kBlockPx,
                      (size.height + kBlockPx - 1) / kBlockPx};
  out.blocks = Image<BlockState>(blocks.width, blocks.height, 1, BlockState::kUnknown);
  const auto sums = blockSumsOf(reference, frame, frame_from_reference, out.level, blocks);
  judge(sums, kBlockPx * kBlockPx / 4, out);
  out.uncertainty_px = uncertaintyOf(sums, out.blocks) * (1 << out.level);
  compareContrast(sums, out);
  findCovered(out, {});
  return out;
}

void findCovered(Agreement& agreement, const Image<BlockState>& also) {
  const int columns = agreement.blocks.width(), rows = agreement.blocks.height();
  cv::Mat fresh(rows, columns, CV_8U, cv::Scalar(0)), labels, stats, middles;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      if (agreement.blocks.at(x, y) == BlockState::kDisagrees &&
          (also.empty() || also.at(x, y) != BlockState::kDisagrees))
        fresh.at<std::uint8_t>(y, x) = 255;
  const int count = cv::connectedComponentsWithStats(fresh, labels, stats, middles, 8);
  int largest = 0, area = 0;
  for (int label = 1; label < count; ++label)
    if (const int here = stats.at<int>(label, cv::CC_STAT_AREA); here > area)
      largest = label, area = here;
  agreement.covered = 0;
  agreement.covered_px = {};
  if (largest == 0) return;
  agreement.covered = static_cast<double>(area) / std::max(agreement.judged_blocks, 1);
  const int side = agreement.block_px << agreement.level;
  agreement.covered_px = {stats.at<int>(largest, cv::CC_STAT_LEFT) * side,
                          stats.at<int>(largest, cv::CC_STAT_TOP) * side,
                          stats.at<int>(largest, cv::CC_STAT_WIDTH) * side,
                          stats.at<int>(largest, cv::CC_STAT_HEIGHT) * side};
}

Image<std::uint8_t> agreeingPixels(const Agreement& agreement, const PreparedPicture& reference) {
  const PictureLevel& level = reference.levels[static_cast<std::size_t>(agreement.level)];
  Image<std::uint8_t> out = level.usable;
  if (out.empty()) out = Image<std::uint8_t>(level.size().width, level.size().height, 1, 255);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x)
      if (agreement.blocks.at(x / agreement.block_px, y / agreement.block_px) ==
          BlockState::kDisagrees)
        out.at(x, y) = 0;
  return out;
}

}  // namespace patina::calibration
