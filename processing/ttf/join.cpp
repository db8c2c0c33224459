// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/join.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace patina::ttf {
namespace {

constexpr int kGapPx = 2;
constexpr double kSameTimeShare = 1e-6;    // of the whole duration
constexpr double kSameDetailShare = 0.02;  // of mm per texel

void checkAgree(const TtfInfo& first, const TtfInfo& other, std::size_t number) {
  const auto refuse = [number](const std::string& why) {
    throw ProcessingError(Exit::kUsage, "input " + std::to_string(number) + " " + why);
  };
  if (other.frames != first.frames)
    refuse("has " + std::to_string(other.frames) + " frames, input 1 has " +
           std::to_string(first.frames) + ": bring them to one rate first (patina ttf retime)");
  if (other.channels != first.channels)
    refuse("has " + std::to_string(other.channels) + " channels, input 1 has " +
           std::to_string(first.channels));
  const double span_s = first.time_s.back() - first.time_s.front();
  for (int t = 0; t < first.frames; ++t) {
    const auto i = static_cast<std::size_t>(t);
    if (std::abs(other.time_s[i] - first.time_s[i]) > kSameTimeShare * span_s)
      refuse("shows frame " + std::to_string(t) + " at " + std::to_string(other.time_s[i]) +
             " s, input 1 at " + std::to_string(first.time_s[i]) +
             " s: bring them to the same times first (patina ttf retime)");
  }
  if (first.mm_per_texel > 0 && other.mm_per_texel > 0 &&
      std::abs(other.mm_per_texel / first.mm_per_texel - 1) > kSameDetailShare)
    refuse("has " + std::to_string(other.mm_per_texel) + " mm per texel, input 1 has " +
           std::to_string(first.mm_per_texel));
}

// Whatever all inputs can be told in.
TtfInfo infoOf(std::span<const TtfReader> inputs) {
  TtfInfo info = inputs[0].info();
  for (std::size_t i = 1; i < inputs.size(); ++i) {
    const TtfInfo& other = inputs[i].info();
    checkAgree(inputs[0].info(), other, i + 1);
    if (other.type != info.type) info.type = std::max({info.type, other.type, SampleType::kU16});
    info.scale = std::max(info.scale, other.scale);
    info.width += kGapPx + other.width;
    info.height = std::max(info.height, other.height);
  }
  info.time_s.clear();
  info.source.clear();
  info.provenance_json.clear();
  return info;
}

template <class T>
void lay(ImageView<const T> frame, RectPx place, ImageView<T> canvas) {
  const int left = std::max(0, place.x - kGapPx / 2),
            right = std::min(canvas.width, place.x + place.width + kGapPx / 2);
  for (int y = 0; y < canvas.height; ++y)
    for (int x = left; x < right; ++x) {
      const auto from =
          frame.texel(std::clamp(x - place.x, 0, place.width - 1), std::min(y, place.height - 1));
      std::copy(from.begin(), from.end(), canvas.texel(x, y).begin());
    }
}

template <class T, class Load>
Image<T> joined(std::span<const TtfReader> inputs, const std::vector<RectPx>& places,
                const TtfInfo& info, Load load) {
  Image<T> canvas(info.width, info.height, info.channels);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const Image<T> frame = load(inputs[i]);
    lay(frame.view(), places[i], canvas.view());
  }
  return canvas;
}

}  // namespace

std::vector<RectPx> joinTtfs(std::span<const TtfReader> inputs, const std::filesystem::path& out,
                             Progress& progress) {
  PATINA_CHECK(!inputs.empty());
  const TtfInfo info = infoOf(inputs);
  std::vector<RectPx> places;
  int x = 0;
  bool as_stored = info.type == SampleType::kU8 || info.type == SampleType::kU16;
  for (const TtfReader& input : inputs) {
    places.push_back({x, 0, input.info().width, input.info().height});
    x += input.info().width + kGapPx;
    as_stored = as_stored && input.info().type == info.type && input.info().scale == info.scale;
  }
  TtfWriter writer(out, info);
  progress.begin("joining", inputs[0].info().frames);
  for (int t = 0; t < inputs[0].info().frames; ++t) {
    const double time_s = inputs[0].info().time_s[static_cast<std::size_t>(t)];
    if (as_stored) {
      const auto frame = joined<std::uint16_t>(inputs, places, info,
                                               [t](const TtfReader& r) { return r.frame(t); });
      writer.add(frame.view(), time_s, Sha256{});
    } else {
      const auto frame =
          joined<float>(inputs, places, info, [t](const TtfReader& r) { return r.linearFrame(t); });
      writer.add(frame.view(), time_s, Sha256{});
    }
    progress.step();
  }
  writer.close();
  return places;
}

}  // namespace patina::ttf
