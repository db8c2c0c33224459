// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/ttf_quilting.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "processing/image/encoding.h"
#include "processing/synthesis/quilting/low_frequency.h"
#include "processing/synthesis/quilting/seam_blend.h"
#include "processing/synthesis/quilting/seam_statistics.h"
#include "processing/synthesis/quilting/time_warp.h"
#include "processing/synthesis/quilting/ttf_features.h"

namespace patina::quilting {
namespace {

constexpr int kFramesMeasured = 8;

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
  Image<std::uint16_t> samples(int t) const { return finished(t, samples_); }
  Image<float> linear(int t) const { return finished(t, linear_); }

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

double seamRatioInFrames(const ResultFrames& frames, const Quilt& quilt) {
  const int count = std::min(kFramesMeasured, frames.count());
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    Image<float> frame = frames.linear(count > 1 ? i * (frames.count() - 1) / (count - 1) : 0);
    for (float& v : frame.texels()) v = srgbFromLinear(v);
    sum += seamRatio(std::as_const(frame).view(), quilt);
  }
  return sum / count;
}

void writeFrames(const ResultFrames& frames, ttf::TtfInfo info, const std::filesystem::path& out,
                 Progress& progress) {
  const std::vector<double> time_s = info.time_s;
  ttf::TtfWriter writer(out, info);
  progress.begin("frames", frames.count());
  for (int t = 0; t < frames.count(); ++t) {
    if (info.type == ttf::SampleType::kU16) {
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
                        const std::filesystem::path& out, const std::string& provenance_json,
                        Progress& progress) {
  const SizePx size{input.info().width, input.info().height};
  options.check(size);
  std::optional<LowFrequency> low;
  if (options.low_frequency != LowFrequencyUse::kKeep)
    low.emplace(input, options.lowFrequencyFor(options.blockFor(size)), progress);
  const QuiltingSource source(input, low ? &*low : nullptr);
  const TtfFeatures f = ttfFeatures(source, options.svd_rank, options.rank_error, progress);
  const JitterOptions jitter{options.jitter_frames, options.jitter_event_frames};
  std::optional<TimeWarps> warps;
  if (jitter.any()) warps.emplace(f, jitter, options.seed);
  QuiltResult result = quilt(f.features.view(), options, progress, warps ? &*warps : nullptr);
  result.report.svd_error = f.relative_error;

  std::optional<SeamBlend> blend;
  if (options.blend_px > 0)
    blend.emplace(seamCorrection(f.features.view(), result.quilt, options.blend_px, options.tile,
                                 progress, warps ? &*warps : nullptr),
                  f, input.info().scale);
  const bool restore = options.low_frequency == LowFrequencyUse::kRestore;
  const ResultFrames frames(source, result.quilt, blend ? &*blend : nullptr,
                            restore ? &*low : nullptr, jitter.walk_frames + jitter.event_frames);
  result.report.seam_ratio_frames = seamRatioInFrames(frames, result.quilt);
  ttf::TtfInfo info = input.info();
  info.width = options.size.width;
  info.height = options.size.height;
  info.provenance_json = provenance_json;
  writeFrames(frames, std::move(info), out, progress);
  return result.report;
}

}  // namespace patina::quilting
