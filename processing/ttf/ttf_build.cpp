// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/ttf_build.h"

#include <cmath>
#include <string>
#include <utility>

namespace patina::ttf {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw ProcessingError(Exit::kUsage, "ttf build: " + what);
}

RectPx regionWithin(const BuildOptions& options, SizePx frame) {
  const RectPx r = options.region.value_or(RectPx{0, 0, frame.width, frame.height});
  if (r.width > frame.width - r.x || r.height > frame.height - r.y)
    refuse("region is " + std::to_string(r.width) + "x" + std::to_string(r.height) + " at " +
           std::to_string(r.x) + "," + std::to_string(r.y) + "; allowed: within the frame of " +
           std::to_string(frame.width) + "x" + std::to_string(frame.height));
  return r;
}

}  // namespace

void BuildOptions::check() const {
  if (every < 1) refuse("every is " + std::to_string(every) + "; allowed: at least 1");
  if (!(scale > 0 && std::isfinite(scale)))
    refuse("scale is " + std::to_string(scale) + "; allowed: above 0");
  if (!(mm_per_texel >= 0 && std::isfinite(mm_per_texel)))
    refuse("mm_per_texel is " + std::to_string(mm_per_texel) + "; allowed: 0 (unknown) or above");
  if (region && (region->x < 0 || region->y < 0 || region->width < 1 || region->height < 1))
    refuse("region is " + std::to_string(region->width) + "x" + std::to_string(region->height) +
           " at " + std::to_string(region->x) + "," + std::to_string(region->y) +
           "; allowed: at least 1x1, from 0,0 on");
}

BuildReport buildTtf(FrameSource& source, const BuildOptions& options, const TtfInfo& about,
                     const std::filesystem::path& out, Progress& progress) {
  options.check();
  progress.begin("time-varying texture", source.count());
  std::optional<TtfWriter> writer;
  SizePx size;
  RectPx region;
  BuildReport report;
  for (std::int64_t index = 0; std::optional<SourceFrame> frame = source.next(); ++index) {
    const ImageView<const float> picture = std::as_const(frame->linear).view();
    if (!writer) {
      size = picture.size();
      region = regionWithin(options, size);
      TtfInfo info = about;
      info.width = region.width;
      info.height = region.height;
      info.channels = picture.channels;
      info.scale = options.scale;
      info.mm_per_texel = options.mm_per_texel;
      writer.emplace(out, info, options.compress);
    } else if (picture.size() != size) {
      throw ProcessingError(Exit::kBadData, "ttf build: frame " + std::to_string(index) + " is " +
                                                std::to_string(picture.width) + "x" +
                                                std::to_string(picture.height) + ", the first " +
                                                std::to_string(size.width) + "x" +
                                                std::to_string(size.height));
    }
    if (index % options.every == 0) {
      writer->add(picture.crop(region), frame->time_s, frame->source);
      ++report.frames;
    }
    progress.step();
  }
  if (!writer) throw ProcessingError(Exit::kBadData, "ttf build: there is no frame to build from");
  report.clipped_samples = writer->clippedSamples();
  writer->close();
  return report;
}

}  // namespace patina::ttf
