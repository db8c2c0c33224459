// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/ttf_quilting.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "processing/image/encoding.h"
#include "processing/synthesis/quilting/low_frequency.h"
#include "processing/synthesis/quilting/seam_blend.h"
#include "processing/synthesis/quilting/seam_metric.h"
#include "processing/synthesis/quilting/seam_statistics.h"
#include "processing/synthesis/quilting/time_warp.h"
#include "processing/synthesis/quilting/ttf_features.h"
#include "processing/ttf/remap.h"

namespace patina::quilting {
namespace {

constexpr int kFramesMeasured = 9;
constexpr double kSeamRatioWanted = 1.06;  // of single texels, the median frame's
constexpr double kAreaRatioWanted = 1.4;   // of areas, the worst frame's: below, none is seen
constexpr double kBlendNear = 1.05;
constexpr double kBlendLeastPx = 0.125, kBlendMostPx = 32;
constexpr int kBlendSteps = 6, kShareSteps = 4, kAreaRadiusPx = 4;
constexpr std::int64_t kRemapBytes = 512 << 20;  // copies alone go by layers up to this size

// Frames of the source as they are asked for: those about the present are kept.
template <class T>
class FrameWindow {
 public:
  using Load = std::function<Image<T>(int)>;
  // `reach`: no frame farther from the present is asked for.
  FrameWindow(Load load, int reach) : load_(std::move(load)), reach_(reach) {}
  void moveTo(int t) {
    frames_.erase(frames_.begin(), frames_.lower_bound(t - reach_));
    frames_.erase(frames_.upper_bound(t + reach_), frames_.end());
  }
  const Image<T>& at(int t) {
    auto it = frames_.find(t);
    if (it == frames_.end()) it = frames_.emplace(t, load_(t)).first;
    return it->second;
  }

 private:
  Load load_;
  int reach_;
  std::map<int, Image<T>> frames_;
};

// Every block's frame `t`, each at its own time.
template <class T>
Image<T> copyAt(int t, const Quilt& quilt, FrameWindow<T>& window) {
  window.moveTo(t);
  std::vector<ImageView<const T>> of_block;
  for (const std::vector<int>& times : quilt.times)
    of_block.push_back(std::as_const(window.at(times[t])).view());
  const SizePx size = quilt.source_xy.size();
  Image<T> out(size.width, size.height, of_block.front().channels);
  tbb::parallel_for(0, size.height, [&](int y) {
    for (int x = 0; x < size.width; ++x) {
      const auto from = quilt.source_xy.view().texel(x, y);
      const auto texel = of_block[quilt.block.at(x, y)].texel(from[0], from[1]);
      std::copy(texel.begin(), texel.end(), out.view().texel(x, y).begin());
    }
  });
  return out;
}

// Frames of the result, one at a time.
class ResultFrames {
 public:
  ResultFrames(const QuiltingSource& source, const Quilt& quilt, const SeamBlend* blend,
               const LowFrequency* to_restore, int reach)
      : source_(source),
        quilt_(quilt),
        blend_(blend),
        to_restore_(to_restore),
        samples_([&source](int t) { return source.frame(t); }, reach),
        linear_([&source](int t) { return source.linearFrame(t); }, reach) {}

  int count() const { return source_.info().frames; }
  // Do blocks show the source as it is, at one time?
  bool areCopies() const { return quilt_.times.empty() && !blend_ && !to_restore_; }
  Image<std::uint16_t> samples(int t) const { return finished(t, samples_); }
  Image<float> linear(int t) const { return finished(t, linear_); }
  // Frames of the source that blocks show at t, by their number.
  std::map<int, Image<float>> sources(int t) const {
    std::map<int, Image<float>> shown;
    if (quilt_.times.empty()) shown.emplace(t, source_.linearFrame(t));
    for (const std::vector<int>& times : quilt_.times) {
      const int at = times[static_cast<std::size_t>(t)];
      if (!shown.count(at)) shown.emplace(at, linear_.at(at));
    }
    return shown;
  }

 private:
  template <class T>
  Image<T> copyOf(int t, FrameWindow<T>& window) const {
    window.moveTo(t);
    return applyQuilt(window.at(t).view(), quilt_);
  }
  template <class T>
  Image<T> finished(int t, FrameWindow<T>& window) const {
    Image<T> result = quilt_.times.empty() ? copyOf(t, window) : copyAt(t, quilt_, window);
    if (blend_) blend_->apply(t, result.view());
    if (to_restore_) to_restore_->putBack(t, result.view());
    return result;
  }

  const QuiltingSource& source_;
  const Quilt& quilt_;
  const SeamBlend* blend_;
  const LowFrequency* to_restore_;
  mutable FrameWindow<std::uint16_t> samples_;
  mutable FrameWindow<float> linear_;
};

struct SeamFigures {
  double median = 0;    // over frames
  double in_place = 0;  // the same, against the sources' gradient at the seams themselves
  double worst = 0;     // frame, of areas
};

void display(Image<float>& frame) {
  tbb::parallel_for(0, frame.height(), [&](int y) {
    float* row = frame.view().row(y);
    for (int j = 0; j < frame.width() * frame.channels(); ++j) row[j] = srgbFromLinear(row[j]);
  });
}

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

double inPlace(const std::map<int, Image<float>>& sources, int t, const Image<float>& frame,
               const Quilt& quilt) {
  std::vector<ImageView<const float>> of_block;
  if (quilt.times.empty()) of_block.push_back(std::as_const(sources.at(t)).view());
  for (const std::vector<int>& times : quilt.times)
    of_block.push_back(std::as_const(sources.at(times[static_cast<std::size_t>(t)])).view());
  return seamRatioInPlace(frame.view(), quilt, of_block);
}

SeamFigures seamFigures(const ResultFrames& frames, const Quilt& quilt) {
  const int count = std::min(kFramesMeasured, frames.count());
  std::vector<double> ratios, in_place;
  SeamFigures figures;
  for (int i = 0; i < count; ++i) {
    const int t = count > 1 ? i * (frames.count() - 1) / (count - 1) : 0;
    std::map<int, Image<float>> sources = frames.sources(t);
    for (auto& [time, source] : sources) display(source);
    Image<float> frame(0, 0, 1);
    if (frames.areCopies()) {  // each sample is displayed once
      frame = applyQuilt(std::as_const(sources.at(t)).view(), quilt);
    } else {
      frame = frames.linear(t);
      display(frame);
    }
    in_place.push_back(inPlace(sources, t, frame, quilt));
    ratios.push_back(seamRatio(std::as_const(frame).view(), quilt));
    figures.worst = std::max(figures.worst,
                             seamRatioOfAreas(std::as_const(frame).view(), quilt, kAreaRadiusPx));
  }
  figures.median = medianOf(std::move(ratios));
  figures.in_place = medianOf(std::move(in_place));
  return figures;
}

// How a correction is made (seam_blend.h).
struct Join {
  double blend_px = 0, one_sided = 0;
};
using FiguresWith = std::function<SeamFigures(const Join&)>;

// The least reach under which seams are no steeper than the rest, nor steps between areas seen in
// any frame; or, where none does so, which comes near the best. Figures fall with the reach.
double leastBlend(const FiguresWith& figures) {
  const auto excess = [&](const SeamFigures& f) {
    return std::max(f.median - kSeamRatioWanted, f.worst - kAreaRatioWanted);
  };
  if (excess(figures({})) <= 0) return 0;
  const double allowed = std::max(0.0, kBlendNear * excess(figures({kBlendMostPx})));
  double low = std::log2(kBlendLeastPx), high = std::log2(kBlendMostPx);
  for (int step = 0; step < kBlendSteps; ++step) {
    const double middle = (low + high) / 2;
    (excess(figures({std::exp2(middle)})) > allowed ? low : high) = middle;
  }
  return std::exp2(high);
}

// The share by which seams go on as one of their sides, so that they are neither fainter nor
// steeper than the rest. The figure rises with it.
double shareOneSided(double blend_px, const FiguresWith& figures) {
  double low = 0, high = 1;
  if (blend_px == 0 || figures({blend_px, low}).median >= 1) return low;
  if (figures({blend_px, high}).median <= 1) return high;
  for (int step = 0; step < kShareSteps; ++step) {
    const double middle = (low + high) / 2;
    (figures({blend_px, middle}).median > 1 ? high : low) = middle;
  }
  return (low + high) / 2;
}

void writeFrames(const ResultFrames& frames, const ttf::TtfInfo& info,
                 const std::filesystem::path& out, Progress& progress) {
  const std::vector<double> time_s = info.time_s;
  ttf::TtfWriter writer(out, info);
  progress.begin("frames", frames.count());
  for (int t = 0; t < frames.count(); ++t) {
    if (info.type == ttf::SampleType::kU16 || info.type == ttf::SampleType::kU8) {
      const Image<std::uint16_t> frame = frames.samples(t);
      writer.add(frame.view(), time_s[t], Sha256{});
    } else {
      const Image<float> frame = frames.linear(t);
      writer.add(frame.view(), time_s[t], Sha256{});
    }
    progress.step();
  }
  writer.close();
}

}  // namespace

QuiltingReport quiltTtf(const ttf::TtfReader& input, const QuiltingOptions& options,
                        const std::filesystem::path& out,
                        const std::function<std::string()>& provenance_json, Progress& progress) {
  const SizePx size{input.info().width, input.info().height};
  options.check(size);
  std::optional<LowFrequency> low;
  if (options.low_frequency != LowFrequencyUse::kKeep)
    low.emplace(input, options.lowFrequencyFor(options.blockFor(size)), progress);
  const QuiltingSource source(input, low ? &*low : nullptr);
  const TtfFeatures f = (options.channels_apart ? ttfFeaturesApart : ttfFeatures)(
      source, options.svd_rank, options.rank_error, progress);
  const JitterOptions jitter{options.jitter_frames, options.jitter_event_frames};
  std::optional<TimeWarps> warps;
  if (jitter.any()) warps.emplace(f, jitter, options.seed);
  const SeamMetric metric = seamMetric(f);
  QuiltResult result =
      quilt(f.features.view(), options, progress, warps ? &*warps : nullptr, &metric);
  result.report.svd_error = f.relative_error;
  result.report.error_of_rank = f.error_of_rank;

  std::optional<SeamBlend> blend;
  const bool restore = options.low_frequency == LowFrequencyUse::kRestore;
  const auto framesWith = [&](const Join& join) {
    blend.reset();
    if (join.blend_px > 0)
      blend.emplace(seamCorrection(f.features.view(), result.quilt, join.blend_px, options.tile,
                                   progress, warps ? &*warps : nullptr, join.one_sided),
                    f, input.info().scale);
    return ResultFrames(source, result.quilt, blend ? &*blend : nullptr, restore ? &*low : nullptr,
                        jitter.walk_frames + jitter.event_frames);
  };
  const FiguresWith figuresWith = [&](const Join& join) {
    return seamFigures(framesWith(join), result.quilt);
  };
  const double blend_px = options.blend_auto ? leastBlend(figuresWith) : options.blend_px;
  const ResultFrames frames = framesWith({blend_px, shareOneSided(blend_px, figuresWith)});
  result.report.blend_px = blend_px;
  const SeamFigures figures = seamFigures(frames, result.quilt);
  result.report.seam_ratio_frames = figures.median;
  result.report.seam_ratio_worst = figures.worst;
  result.report.seam_ratio_in_place = figures.in_place;
  if (!jitter.any() && !blend && !low &&
      ttf::remapBytes(input.info(), options.size) <= kRemapBytes) {
    ttf::remapTtf(input, result.quilt.source_xy.view(), out, provenance_json, progress);
    return result.report;
  }
  ttf::TtfInfo info = input.info();
  info.width = options.size.width;
  info.height = options.size.height;
  info.provenance_json = provenance_json();
  writeFrames(frames, info, out, progress);
  return result.report;
}

}  // namespace patina::quilting
