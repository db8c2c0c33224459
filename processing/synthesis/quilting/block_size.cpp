// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/block_size.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "processing/patch/spectra.h"
#include "processing/synthesis/quilting/displayed_rows.h"

namespace patina::quilting {
namespace {

constexpr int kFrames = 9;
constexpr double kFallen = 0.25, kFeaturesABlock = 4, kContrastLeast = 1.0 / 3;
// Of the source's side, at most; along strokes and grain, features longer than twice their width.
constexpr double kShare = 0.5, kShareAlong = 2.0 / 3, kStroke = 2;
constexpr int kSideLeast = 24, kSideMost = 320;

// Less the mean over a square of 2 * reach + 1.
Image<float> flattened(ImageView<const float> picture, int reach) {
  const int w = picture.width, h = picture.height;
  std::vector<double> sums(static_cast<std::size_t>(w + 1) * (h + 1));
  const auto at = [&](int x, int y) -> double& {
    return sums[static_cast<std::size_t>(y) * (w + 1) + x];
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      at(x + 1, y + 1) = picture.at(x, y) + at(x, y + 1) + at(x + 1, y) - at(x, y);
  Image<float> out(w, h, 1);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const int x0 = std::max(0, x - reach), x1 = std::min(w, x + reach + 1),
                y0 = std::max(0, y - reach), y1 = std::min(h, y + reach + 1);
      const double mean = (at(x1, y1) - at(x0, y1) - at(x1, y0) + at(x0, y0)) /
                          (static_cast<double>(x1 - x0) * (y1 - y0));
      out.at(x, y) = static_cast<float>(picture.at(x, y) - mean);
    }
  return out;
}

// Where it falls below the threshold, between lags.
double fallenAt(const std::vector<double>& correlation) {
  for (std::size_t lag = 1; lag < correlation.size(); ++lag)
    if (correlation[lag] < kFallen) {
      const double drop = correlation[lag - 1] - correlation[lag];
      return static_cast<double>(lag) - 1 + (correlation[lag - 1] - kFallen) / drop;
    }
  return static_cast<double>(correlation.size());
}

Image<float> luma(const Image<std::uint16_t>& frame, const std::vector<float>& display) {
  Image<float> out(frame.width(), frame.height(), 1);
  const int channels = frame.channels();
  for (std::size_t i = 0; i < out.texels().size(); ++i) {
    float sum = 0;
    for (int c = 0; c < channels; ++c) sum += display[frame.texels()[i * channels + c]];
    out.texels()[i] = sum / static_cast<float>(channels);
  }
  return out;
}

double contrastOf(const Image<float>& picture) {
  double sum = 0, squares = 0;
  for (float v : picture.texels()) {
    sum += v;
    squares += static_cast<double>(v) * v;
  }
  const double n = static_cast<double>(picture.texels().size());
  return std::sqrt(std::max(0.0, squares / n - sum / n * sum / n));
}

int side(double feature_px, double across_px, int source_px) {
  const int wanted = 4 * static_cast<int>(std::lround(kFeaturesABlock * feature_px / 4));
  const double share = feature_px > kStroke * across_px ? kShareAlong : kShare;
  const int most = std::clamp(4 * static_cast<int>(share * source_px / 4),
                              std::min(kSideLeast, source_px), kSideMost);
  return std::clamp(wanted, std::min(kSideLeast, most), most);
}

}  // namespace

FeatureSize featureSize(ImageView<const float> picture) {
  const int w = picture.width, h = picture.height;
  const Image<float> flat = flattened(picture, std::max(2, std::min(w, h) / 8));
  const patch::Spectra spectra({2 * w, 2 * h});
  patch::Spectra::Spectrum bins;
  const int stride = spectra.padded().width;
  patch::Spectra::Plane plane(static_cast<std::size_t>(stride) * h);
  for (int y = 0; y < h; ++y)
    std::copy_n(flat.view().row(y), w, plane.data() + static_cast<std::ptrdiff_t>(y) * stride);
  spectra.forward(plane, bins);
  for (auto& v : bins) v = std::norm(v);
  patch::Spectra::Plane products;
  spectra.inverse(bins, products);
  const double energy = products[0];
  if (!(energy > 1e-9 * w * h)) return {};
  std::vector<double> across, down;
  for (int lag = 0; lag < w / 2; ++lag) across.push_back(products[lag] / energy * w / (w - lag));
  for (int lag = 0; lag < h / 2; ++lag)
    down.push_back(products[static_cast<std::size_t>(lag) * stride] / energy * h / (h - lag));
  return {2 * fallenAt(across), 2 * fallenAt(down)};
}

BlockProposal proposeBlock(const QuiltingSource& source) {
  const int frames = source.info().frames, count = std::min(kFrames, frames);
  const std::vector<float> display = displayTable(source.info().scale);
  BlockProposal proposal;
  std::vector<double> contrast;
  for (int i = 0; i < count; ++i) {
    const Image<float> picture =
        luma(source.frame(count > 1 ? i * (frames - 1) / (count - 1) : 0), display);
    contrast.push_back(contrastOf(picture));
    proposal.features.push_back(featureSize(picture.view()));
  }
  const double strongest = *std::max_element(contrast.begin(), contrast.end());
  FeatureSize least{1e9, 1e9}, largest;
  for (int i = 0; i < count; ++i) {
    if (contrast[i] < kContrastLeast * strongest) continue;
    const FeatureSize& f = proposal.features[i];
    least = {std::min(least.width_px, f.width_px), std::min(least.height_px, f.height_px)};
    largest = {std::max(largest.width_px, f.width_px), std::max(largest.height_px, f.height_px)};
  }
  proposal.block = {side(largest.width_px, largest.height_px, source.info().width),
                    side(largest.height_px, largest.width_px, source.info().height)};
  char text[200];
  std::snprintf(text, sizeof text,
                "features are %.0fx%.0f px at the least and %.0fx%.0f px at the most over the "
                "sequence; a block of %dx%d holds four of the largest, as far as the sample allows",
                least.width_px, least.height_px, largest.width_px, largest.height_px,
                proposal.block.width, proposal.block.height);
  proposal.reason = text;
  return proposal;
}

}  // namespace patina::quilting
