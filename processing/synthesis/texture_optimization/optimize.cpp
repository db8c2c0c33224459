// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/optimize.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "processing/image/random.h"
#include "processing/patch/euclidean.h"

namespace patina::texture_optimization {
namespace {

constexpr std::size_t kVotesMax = 49;  // of patches of 7

SizePx halved(SizePx size, int times) {
  return {std::max(1, size.width >> times), std::max(1, size.height >> times)};
}

int levelsFor(SizePx source, const OptimizeOptions& options) {
  int levels = 1;
  while (true) {
    const SizePx next = halved(source, levels);
    if (std::min(next.width, next.height) < options.coarsest_px) return levels;
    ++levels;
  }
}

// Averages over the area of each texel of the smaller image.
Image<std::int16_t> averaged(const Image<std::int16_t>& in, SizePx size) {
  if (in.size() == size) return in;
  const int channels = in.channels();
  Image<std::int16_t> out(size.width, size.height, channels);
  const double sx = static_cast<double>(in.width()) / size.width,
               sy = static_cast<double>(in.height()) / size.height;
  tbb::parallel_for(0, size.height, [&](int y) {
    std::vector<double> sum(static_cast<std::size_t>(channels));
    for (int x = 0; x < size.width; ++x) {
      std::fill(sum.begin(), sum.end(), 0);
      for (int iy = static_cast<int>(y * sy); iy < std::min<double>(in.height(), (y + 1) * sy);
           ++iy)
        for (int ix = static_cast<int>(x * sx); ix < std::min<double>(in.width(), (x + 1) * sx);
             ++ix) {
          const double share = (std::min(ix + 1.0, (x + 1) * sx) - std::max<double>(ix, x * sx)) *
                               (std::min(iy + 1.0, (y + 1) * sy) - std::max<double>(iy, y * sy));
          for (int c = 0; c < channels; ++c)
            sum[static_cast<std::size_t>(c)] += share * in.at(ix, iy, c);
        }
      for (int c = 0; c < channels; ++c)
        out.at(x, y, c) =
            static_cast<std::int16_t>(std::lrint(sum[static_cast<std::size_t>(c)] / (sx * sy)));
    }
  });
  return out;
}

std::vector<std::int32_t> scattered(SizePx source, SizePx target,
                                    const patch::FieldOptions& field) {
  const int reach = field.patch / 2;
  std::vector<std::int32_t> out;
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x) {
      const std::uint64_t key =
          hashSeed(field.seed, 0x73, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
      const auto within = [&](std::uint64_t seed, int length) {
        return reach +
               static_cast<int>(uniformBelow(seed, static_cast<std::uint64_t>(length - 2 * reach)));
      };
      out.push_back(within(hashSeed(key, 1), source.height) * source.width +
                    within(hashSeed(key, 2), source.width));
    }
  return out;
}

// The coarser level's centres, each for four patches.
std::vector<std::int32_t> refined(const std::vector<std::int32_t>& coarse, SizePx coarse_source,
                                  SizePx coarse_target, SizePx source, SizePx target, int reach) {
  std::vector<std::int32_t> out;
  out.reserve(static_cast<std::size_t>(target.width) * static_cast<std::size_t>(target.height));
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x) {
      const int cx = std::min(x / 2, coarse_target.width - 1),
                cy = std::min(y / 2, coarse_target.height - 1);
      const std::int32_t centre =
          coarse[static_cast<std::size_t>(cy) * static_cast<std::size_t>(coarse_target.width) +
                 static_cast<std::size_t>(cx)];
      const int sx = centre % coarse_source.width * 2 + x % 2,
                sy = centre / coarse_source.width * 2 + y % 2;
      out.push_back(std::clamp(sy, reach, source.height - 1 - reach) * source.width +
                    std::clamp(sx, reach, source.width - 1 - reach));
    }
  return out;
}

}  // namespace

void OptimizeOptions::check(SizePx source) const {
  field.check();
  const auto refuse = [](const std::string& what) { throw ProcessingError(Exit::kUsage, what); };
  const std::string patch = std::to_string(field.patch);
  if (std::min(source.width, source.height) < field.patch)
    refuse("the sample is " + std::to_string(source.width) + "x" + std::to_string(source.height) +
           " texels, smaller than the patch of " + patch);
  if (std::min(size.width, size.height) < field.patch)
    refuse("the result is " + std::to_string(size.width) + "x" + std::to_string(size.height) +
           " texels, smaller than the patch of " + patch);
  if (size.width > 32768 || size.height > 32768) refuse("the result is larger than 32768 texels");
  if (rounds < 1 || rounds > 1000 || passes < 1 || passes > 1000)
    refuse("rounds and passes lie between 1 and 1000");
  if (components != 8 && components != 16)
    refuse("components are " + std::to_string(components) + "; allowed: 8, 16");
  if (coarsest_px < field.patch + 1) refuse("the coarsest level is no larger than the patch");
}

OptimizedField optimize(ImageView<const float> features, const OptimizeOptions& options,
                        Progress& progress) {
  options.check(features.size());
  const patch::CompactFeatures compact =
      patch::compactFeatures(features, options.components, options.field.patch, progress);
  OptimizedField out;
  out.size = options.size;
  out.left_out = compact.left_out;
  out.levels = levelsFor(features.size(), options);
  // Work of a level grows with its texels.
  const auto work = [&](int level) {
    return std::max<std::int64_t>(1, (std::int64_t{1} << 20) >> (2 * level));
  };
  std::int64_t total = 0;
  for (int level = 0; level < out.levels; ++level) total += work(level) * options.rounds;
  progress.begin("optimising", total);

  SizePx coarse_source, coarse_target;
  for (int level = out.levels - 1; level >= 0; --level) {
    const SizePx source_size = halved(features.size(), level);
    SizePx target_size = halved(options.size, level);
    target_size.width = std::max(target_size.width, options.field.patch);
    target_size.height = std::max(target_size.height, options.field.patch);
    const Image<std::int16_t> source = averaged(compact.texels, source_size);
    patch::FieldOptions field_options = options.field;
    field_options.seed = hashSeed(options.field.seed, static_cast<std::uint64_t>(level));
    patch::NearestField field(source.view(), compact.scale, target_size, field_options);
    field.start(level == out.levels - 1
                    ? scattered(source_size, target_size, options.field)
                    : refined(out.centres, coarse_source, coarse_target, source_size, target_size,
                              options.field.patch / 2));
    field.vote();
    for (int round = 0; round < options.rounds; ++round) {
      for (int pass = 0; pass < options.passes; ++pass) field.search(round * options.passes + pass);
      field.vote();
      progress.step(work(level));
    }
    out.energy = field.energy();
    out.centres = field.centres();
    coarse_source = source_size;
    coarse_target = target_size;
  }
  return out;
}

Image<float> voted(ImageView<const float> source, const OptimizedField& field, int patch) {
  const int width = field.size.width, height = field.size.height, channels = source.channels;
  const patch::Votes votes{field.centres, field.size,  source.width,
                           patch / 2,     field.wraps, field.kept};
  Image<float> out(width, height, channels);
  const auto at = [&](std::int32_t texel) {
    return &source.at(texel % source.width, texel / source.width);
  };
  tbb::parallel_for(0, height, [&](int y) {
    std::array<std::int32_t, kVotesMax> shown;
    for (int x = 0; x < width; ++x) {
      std::size_t count = 0;
      bool agreed = true;
      patch::forEachVote(votes, x, y, [&](std::int32_t texel, int, int) {
        shown[count++] = texel;
        agreed &= texel == shown[0];
      });
      float* to = &out.at(x, y);
      if (agreed) {
        std::copy_n(at(shown[0]), channels, to);
        continue;
      }
      for (std::size_t i = 0; i < count; ++i) {
        const float* from = at(shown[i]);
        for (int c = 0; c < channels; ++c) to[c] += from[c];
      }
      const float share = 1.0f / static_cast<float>(count);
      for (int c = 0; c < channels; ++c) to[c] *= share;
    }
  });
  return out;
}

}  // namespace patina::texture_optimization
