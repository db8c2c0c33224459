// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/ttf_quilting.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "processing/image/encoding.h"
#include "processing/synthesis/quilting/low_frequency.h"
#include "processing/synthesis/quilting/seam_blend.h"
#include "processing/synthesis/quilting/seam_statistics.h"
#include "processing/synthesis/quilting/ttf_features.h"

namespace patina::quilting {
namespace {

constexpr int kFramesMeasured = 8;

// Frames of the result, one at a time.
class ResultFrames {
 public:
  ResultFrames(const QuiltingSource& source, const Quilt& quilt, const SeamBlend* blend,
               const LowFrequency* to_restore)
      : source_(source), quilt_(quilt), blend_(blend), to_restore_(to_restore) {}

  int count() const { return source_.info().frames; }
  Image<std::uint16_t> samples(int t) const { return finished(t, source_.frame(t)); }
  Image<float> linear(int t) const { return finished(t, source_.linearFrame(t)); }

 private:
  template <class T>
  Image<T> finished(int t, const Image<T>& frame) const {
    Image<T> result = applyQuilt(frame.view(), quilt_);
    if (blend_) blend_->apply(t, result.view());
    if (to_restore_) to_restore_->putBack(t, result.view());
    return result;
  }

  const QuiltingSource& source_;
  const Quilt& quilt_;
  const SeamBlend* blend_;
  const LowFrequency* to_restore_;
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
  QuiltResult result = quilt(f.features.view(), options, progress);
  result.report.svd_error = f.relative_error;

  std::optional<SeamBlend> blend;
  if (options.blend_px > 0)
    blend.emplace(
        seamCorrection(f.features.view(), result.quilt, options.blend_px, options.tile, progress),
        f, input.info().scale);
  const bool restore = options.low_frequency == LowFrequencyUse::kRestore;
  const ResultFrames frames(source, result.quilt, blend ? &*blend : nullptr,
                            restore ? &*low : nullptr);
  result.report.seam_ratio_frames = seamRatioInFrames(frames, result.quilt);
  ttf::TtfInfo info = input.info();
  info.width = options.size.width;
  info.height = options.size.height;
  info.provenance_json = provenance_json;
  writeFrames(frames, std::move(info), out, progress);
  return result.report;
}

}  // namespace patina::quilting
