// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/ttf_optimize.h"

#include <algorithm>

#include "processing/decomposition/temporal_svd.h"

namespace patina::texture_optimization {
namespace {

constexpr int kRank = 16;  // of histories, as they are compared
constexpr std::int64_t kFloatBytes = 4, kSearchBytes = 200, kFieldBytes = 80;

std::int64_t texelsOf(SizePx size) { return std::int64_t{size.width} * size.height; }

// [h][w][rank] scores of the texels' histories, all channels together.
Image<float> historiesOf(const ttf::TtfReader& input, Progress& progress) {
  const ttf::TtfInfo& info = input.info();
  const std::int64_t texels = texelsOf({info.width, info.height}),
                     samples = std::int64_t{info.frames} * info.channels;
  std::vector<float> planes(static_cast<std::size_t>(samples * texels));
  progress.begin("frames", info.frames);
  float* plane = planes.data();
  for (int t = 0; t < info.frames; ++t) {
    const Image<float> frame = input.linearFrame(t);
    for (int c = 0; c < info.channels; ++c)
      for (std::int64_t i = 0; i < texels; ++i)
        *plane++ = frame.texels()[static_cast<std::size_t>(i * info.channels + c)];
    progress.step();
  }
  decomposition::SvdOptions options;
  options.rank = static_cast<int>(std::min<std::int64_t>({kRank, samples, texels}));
  options.centre = true;
  const decomposition::TemporalSvd svd =
      decomposition::temporalSvd(texels, samples, planes, options, progress);
  Image<float> out(info.width, info.height, svd.rank);
  out.texels() = svd.scores;
  return out;
}

}  // namespace

LargerPicture enlargePicture(ImageView<const float> picture, const OptimizeOptions& options,
                             const Constraints& constraints, Progress& progress) {
  LargerPicture out;
  out.field = optimize(picture, options, constraints, progress);
  out.picture = shown(picture, out.field);
  return out;
}

OptimizedField optimizeTtf(const ttf::TtfReader& input, const OptimizeOptions& options,
                           const Constraints& constraints, const std::filesystem::path& out,
                           const std::string& provenance_json, Progress& progress) {
  ttf::TtfInfo info = input.info();
  options.check({info.width, info.height});
  const Image<float> histories = historiesOf(input, progress);
  OptimizedField field = optimize(histories.view(), options, constraints, progress);
  const std::vector<double> time_s = info.time_s;
  info.width = options.size.width;
  info.height = options.size.height;
  info.provenance_json = provenance_json;
  ttf::TtfWriter writer(out, info);
  progress.begin("frames", info.frames);
  for (int t = 0; t < info.frames; ++t) {
    const Image<float> sample = input.linearFrame(t), frame = shown(sample.view(), field);
    writer.add(frame.view(), time_s[static_cast<std::size_t>(t)], Sha256{});
    progress.step();
  }
  writer.close();
  return field;
}

std::int64_t pictureBytes(SizePx sample, int channels, SizePx size) {
  return texelsOf(sample) * (3 * kFloatBytes * channels + kSearchBytes) +
         texelsOf(size) * (kFloatBytes * channels + kFieldBytes);
}

std::int64_t ttfBytes(const ttf::TtfInfo& info, SizePx size) {
  constexpr std::int64_t kFramesWritten = 8;
  return texelsOf({info.width, info.height}) *
             (kFloatBytes * info.channels * info.frames + kSearchBytes) +
         texelsOf(size) * (kFramesWritten * kFloatBytes * info.channels + kFieldBytes);
}

}  // namespace patina::texture_optimization
