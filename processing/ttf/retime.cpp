// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/ttf/retime.h"

#include <half.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "processing/ttf/volume_file.h"

namespace patina::ttf {
namespace {

using hdf5::kChunkFrames;

[[noreturn]] void refuse(const std::string& why) { throw ProcessingError(Exit::kUsage, why); }

void checkMap(const Image<float>& map, const TtfInfo& input, const std::string& name) {
  if (map.width() != input.width || map.height() != input.height || map.channels() != 1)
    refuse("the " + name + " is " + std::to_string(map.width()) + "x" +
           std::to_string(map.height()) + " with " + std::to_string(map.channels()) +
           " channels; the texture is " + std::to_string(input.width) + "x" +
           std::to_string(input.height) + ", so it must be, with one channel");
  for (const float v : map.texels())
    if (!(v >= 0 && v <= 1e6f))
      refuse("the " + name + " holds " + std::to_string(v) + "; allowed: 0 to 1000000");
}

std::pair<float, float> rangeOf(const std::vector<RateKey>& rates) {
  std::pair<float, float> range{1, 1};
  bool first = true;
  for (const RateKey& key : rates)
    for (const float v : key.rate.texels()) {
      range =
          first ? std::pair(v, v) : std::pair(std::min(range.first, v), std::max(range.second, v));
      first = false;
    }
  return range;
}

double lengthOf(const TtfInfo& input) { return input.time_s.back() - input.time_s.front(); }

// What rates are divided by: the fastest texel then has exactly 1, and ages bit for bit as
// captured.
double unitRateOf(const RetimeOptions& options) {
  return options.fastest_as_captured ? rangeOf(options.rates).second : 1;
}

// Seconds by which a texel has aged at `time_s`: the integral of its rate.
class Ages {
 public:
  Ages(const RetimeOptions& options, double length_s)
      : options_(options), unit_(unitRateOf(options)), length_s_(length_s) {}

  double at(int x, int y, double time_s) const {
    const double start = options_.start_s.empty() ? 0 : options_.start_s.at(x, y);
    if (time_s <= start) return 0;
    double age = time_s - start;
    if (options_.rates.size() == 1)
      age *= rate(0, x, y);
    else if (!options_.rates.empty())
      age = integral(x, y, time_s) - integral(x, y, start);
    return std::min(age, length_s_);
  }

 private:
  double rate(std::size_t key, int x, int y) const {
    return options_.rates[key].rate.at(x, y) / unit_;
  }
  double integral(int x, int y, double time_s) const {
    const std::vector<RateKey>& keys = options_.rates;
    double sum = std::min(time_s, keys.front().time_s) * rate(0, x, y);
    for (std::size_t k = 0; k < keys.size() && keys[k].time_s < time_s; ++k) {
      const double from = keys[k].time_s;
      if (k + 1 == keys.size()) {
        sum += (time_s - from) * rate(k, x, y);
        break;
      }
      const double gap = keys[k + 1].time_s - from,
                   part = std::min(time_s, keys[k + 1].time_s) - from;
      const double here = rate(k, x, y), next = here + (rate(k + 1, x, y) - here) * part / gap;
      sum += part * (here + next) / 2;
    }
    return sum;
  }

  const RetimeOptions& options_;
  double unit_, length_s_;
};

// One sample's history, `stride` apart, read between frames.
template <class T>
class History {
 public:
  History(const T* samples, std::size_t stride, const std::vector<double>& time_s)
      : samples_(samples), stride_(stride), time_s_(time_s) {}

  // At `share` of the way from frame i to the next; 0 <= share < 1.
  double at(std::size_t i, double share, Between between) const {
    if (share == 0) return value(i);
    if (between == Between::kNearest) return value(share < 0.5 ? i : i + 1);
    const double a = value(i), b = value(i + 1);
    if (between == Between::kLinear) return a + (b - a) * share;
    const double h = time_s_[i + 1] - time_s_[i], m = (b - a) / h, from = slope(i),
                 to = slope(i + 1);
    const double c3 = (from + to - 2 * m) * h, c2 = (3 * m - 2 * from - to) * h;
    return ((c3 * share + c2) * share + from * h) * share + a;
  }

 private:
  double value(std::size_t i) const { return static_cast<double>(samples_[i * stride_]); }
  double secant(std::size_t i) const {
    return (value(i + 1) - value(i)) / (time_s_[i + 1] - time_s_[i]);
  }
  // Steffen 1990, equations 8 to 11; at the ends that of the one secant.
  double slope(std::size_t i) const {
    if (i == 0) return secant(0);
    if (i + 1 == time_s_.size()) return secant(i - 1);
    const double left = secant(i - 1), right = secant(i);
    const double before = time_s_[i] - time_s_[i - 1], after = time_s_[i + 1] - time_s_[i];
    const double parabola = (left * after + right * before) / (before + after);
    const auto sign = [](double v) { return v > 0 ? 1.0 : v < 0 ? -1.0 : 0.0; };
    return (sign(left) + sign(right)) *
           std::min({std::abs(left), std::abs(right), 0.5 * std::abs(parabola)});
  }

  const T* samples_;
  std::size_t stride_;
  const std::vector<double>& time_s_;
};

template <class Stored>
Stored stored(double v) {
  if constexpr (std::is_same_v<Stored, std::uint16_t>)
    return static_cast<std::uint16_t>(std::floor(std::clamp(v, 0.0, 65535.0) + 0.5));
  else
    return static_cast<Stored>(static_cast<float>(v));
}

// A texture whose frames share a moment: the later one is out of reach.
std::vector<double> fromZero(const TtfInfo& input) {
  std::vector<double> time_s;
  for (const double t : input.time_s) time_s.push_back(t - input.time_s.front());
  for (std::size_t i = 1; i < time_s.size(); ++i)
    if (!(time_s[i] > time_s[i - 1]))
      throw ProcessingError(Exit::kBadData, "frames " + std::to_string(i - 1) + " and " +
                                                std::to_string(i) + " have the same time");
  return time_s;
}

// Reads, resamples and writes one column of chunks.
template <class Read, class Stored>
class Column {
 public:
  Column(std::vector<Read> samples, RectPx region, const TtfInfo& input,
         const std::vector<double>& time_s)
      : samples_(std::move(samples)), region_(region), channels_(input.channels), time_s_(time_s) {}

  void layer(const Ages& ages, const std::vector<double>& out_s, int first, int count,
             Between between, SizePx chunk, std::byte* bytes) const {
    auto* out = reinterpret_cast<Stored*>(bytes);
    const std::size_t frame = static_cast<std::size_t>(region_.width) * region_.height * channels_;
    tbb::parallel_for(0, region_.height, [&](int y) {
      for (int x = 0; x < region_.width; ++x) {
        const std::size_t texel = (static_cast<std::size_t>(y) * region_.width + x) * channels_;
        for (int t = 0; t < count; ++t) {
          const auto [index, share] =
              place(ages.at(region_.x + x, region_.y + y, out_s[first + t]));
          Stored* to = out + ((static_cast<std::size_t>(t) * chunk.height + y) * chunk.width + x) *
                                 channels_;
          for (int c = 0; c < channels_; ++c)
            to[c] = stored<Stored>(History<Read>(samples_.data() + texel + c, frame, time_s_)
                                       .at(index, share, between));
        }
      }
    });
  }

 private:
  struct Place {
    std::size_t index;
    double share;
  };
  Place place(double age_s) const {
    const auto after = std::upper_bound(time_s_.begin(), time_s_.end(), age_s);
    const auto i = static_cast<std::size_t>(after - time_s_.begin()) - 1;
    if (i + 1 == time_s_.size()) return {i, 0};
    return {i, (age_s - time_s_[i]) / (time_s_[i + 1] - time_s_[i])};
  }

  std::vector<Read> samples_;
  RectPx region_;
  int channels_;
  const std::vector<double>& time_s_;
};

template <class Read, class Stored, class Load>
void writeColumns(const Load& load, const TtfInfo& input, const RetimeOptions& options,
                  const std::vector<double>& out_s, VolumeFile& file, Progress& progress) {
  const std::vector<double> time_s = fromZero(input);
  const Ages ages(options, lengthOf(input));
  const SizePx chunk = file.chunk();
  const int frames = static_cast<int>(out_s.size());
  progress.begin("texture", file.chunks().width * file.chunks().height);
  std::vector<std::byte> bytes(file.chunkBytes());
  for (int cy = 0; cy < file.chunks().height; ++cy)
    for (int cx = 0; cx < file.chunks().width; ++cx) {
      const RectPx region{cx * chunk.width, cy * chunk.height,
                          std::min(chunk.width, input.width - cx * chunk.width),
                          std::min(chunk.height, input.height - cy * chunk.height)};
      const Column<Read, Stored> column(load(region), region, input, time_s);
      for (int first = 0; first < frames; first += kChunkFrames) {
        const int count = std::min(kChunkFrames, frames - first);
        std::fill(bytes.begin(), bytes.end(), std::byte{0});
        column.layer(ages, out_s, first, count, options.between, chunk, bytes.data());
        file.writeChunk(first, count, cx, cy, bytes.data());
      }
      progress.step();
    }
}

double endedShare(const TtfInfo& input, const RetimeOptions& options, double at_s) {
  const Ages ages(options, lengthOf(input));
  std::int64_t ended = 0;
  for (int y = 0; y < input.height; ++y)
    for (int x = 0; x < input.width; ++x) ended += ages.at(x, y, at_s) >= lengthOf(input);
  return static_cast<double>(ended) / (static_cast<double>(input.width) * input.height);
}

}  // namespace

void RetimeOptions::check(const TtfInfo& input) const {
  if (input.frames < 2)
    throw ProcessingError(Exit::kBadData, "a texture of one frame has no pace that could change");
  for (const RateKey& key : rates) checkMap(key.rate, input, "rate map");
  for (std::size_t i = 1; i < rates.size(); ++i)
    if (!(rates[i].time_s > rates[i - 1].time_s)) refuse("the rate maps are not in order of time");
  if (!start_s.empty()) checkMap(start_s, input, "map of starts");
  if (!(rangeOf(rates).second > 0)) refuse("the rate map is 0 everywhere: nothing would ever age");
  if (duration_s && !(*duration_s > 0 && std::isfinite(*duration_s)))
    refuse("the duration is " + std::to_string(*duration_s) + " s; allowed: above 0");
  if (frames && (*frames < 2 || *frames > 10'000'000))
    refuse("frames is " + std::to_string(*frames) + "; allowed: 2 to 10000000");
  for (std::size_t i = 0; i < at_s.size(); ++i)
    if (!(at_s[i] >= 0 && at_s[i] < 1e18) || (i > 0 && !(at_s[i] > at_s[i - 1])))
      refuse("the times of the result's frames do not rise from 0 on");
}

std::vector<double> retimedTimes(const TtfInfo& input, const RetimeOptions& options) {
  const double fastest = std::max(1e-6, rangeOf(options.rates).second / unitRateOf(options));
  if (!options.at_s.empty()) return options.at_s;
  std::vector<double> times;
  for (const double t : input.time_s) times.push_back((t - input.time_s.front()) / fastest);
  const double end = options.duration_s.value_or(times.back());
  if (options.frames) {
    times.clear();
    for (int i = 0; i < *options.frames; ++i) times.push_back(end * i / (*options.frames - 1));
    return times;
  }
  const double step = times.back() / static_cast<double>(times.size() - 1);
  while (times.size() > 1 && times.back() > end) times.pop_back();
  while (times.back() + step <= end * (1 + 1e-12)) {
    times.push_back(times.back() + step);
    if (times.size() > 10'000'000) refuse("the result would have more than 10000000 frames");
  }
  return times;
}

RetimeReport retimeTtf(const TtfReader& input, const RetimeOptions& options,
                       const std::filesystem::path& out, const std::string& provenance_json,
                       Progress& progress) {
  TtfInfo info = input.info();
  options.check(info);
  const std::vector<double> times = retimedTimes(info, options);
  const auto samples = [&](RectPx region) { return input.block(0, info.frames, region); };
  const auto linear = [&](RectPx region) { return input.linearBlock(0, info.frames, region); };
  if (info.type == SampleType::kU8) info.type = SampleType::kU16;  // ages lie between its codes
  VolumeFile file(out, info, false);
  file.extend(static_cast<int>(times.size()));
  switch (info.type) {
    case SampleType::kU8:
    case SampleType::kU16:
      writeColumns<std::uint16_t, std::uint16_t>(samples, info, options, times, file, progress);
      break;
    case SampleType::kF16:
      writeColumns<float, half>(linear, info, options, times, file, progress);
      break;
    case SampleType::kF32:
      writeColumns<float, float>(linear, info, options, times, file, progress);
      break;
  }
  RetimeReport report;
  report.frames = static_cast<int>(times.size());
  report.duration_s = times.back();
  const auto [least, greatest] = rangeOf(options.rates);
  report.rate_least = least / unitRateOf(options);
  report.rate_greatest = greatest / unitRateOf(options);
  report.ended_share = endedShare(info, options, times.back());
  const double t0_s = info.time_s.front();
  info.frames = report.frames;
  info.time_s = times;
  for (double& t : info.time_s) t += t0_s;
  info.source.assign(times.size(), Sha256{});
  info.provenance_json = provenance_json;
  file.publish(info);
  return report;
}

}  // namespace patina::ttf
