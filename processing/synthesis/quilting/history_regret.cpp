// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/history_regret.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>

#include "processing/patch/spectra.h"
#include "processing/synthesis/quilting/displayed_rows.h"

namespace patina::quilting {
namespace {

using patch::Spectra;

constexpr std::size_t kLeast = 8;  // corners by FFT that are summed exactly

struct Shape {
  SizePx block, overlap;
  // Where the texel of an overlap comes from.
  PointPx from(const Placement& place, int x, int y) const {
    const PointPx& corner = y < overlap.height ? place.whole : place.left;
    return {corner.x + x, corner.y + y};
  }
  template <class Use>
  void forTexels(const Use& use) const {
    for (int y = 0; y < block.height; ++y)
      for (int x = 0; x < (y < overlap.height ? block.width : overlap.width); ++x) use(x, y);
  }
};

// Frames as they are compared: displayed, less the frame's middle, times its weight; one plane a
// channel.
class Frames {
 public:
  Frames(const QuiltingSource& source, std::span<const float> weight)
      : source_(source), weight_(weight), display_(displayTable(source.info().scale)) {}

  void forPlanes(Progress& progress, const std::function<void(const Image<float>&)>& use) const {
    progress.begin("histories", source_.info().frames);
    for (int t = 0; t < source_.info().frames; ++t, progress.step()) {
      const Image<std::uint16_t> frame = source_.frame(t);
      for (int c = 0; c < frame.channels(); ++c) {
        Image<float> plane(frame.width(), frame.height(), 1);
        double sum = 0;
        for (int y = 0; y < frame.height(); ++y)
          for (int x = 0; x < frame.width(); ++x)
            sum += plane.at(x, y) = display_[frame.at(x, y, c)];
        const auto middle = static_cast<float>(sum / static_cast<double>(plane.texels().size()));
        for (float& v : plane.texels()) v = (v - middle) * weight_[static_cast<std::size_t>(t)];
        use(plane);
      }
    }
  }

 private:
  const QuiltingSource& source_;
  std::span<const float> weight_;
  std::vector<float> display_;
};

// Sums over frames, in the frequency domain, of what every placement's overlap and the source have
// in common.
class Correlations {
 public:
  Correlations(SizePx source, const Shape& shape, const std::vector<Placement>& placements)
      : source_(source),
        shape_(shape),
        placements_(placements),
        spectra_(source),
        energy_(source.width, source.height, 1),
        products_(placements.size()) {}

  void add(const Image<float>& plane) {
    Spectra::Plane padded(area());
    for (int y = 0; y < source_.height; ++y)
      std::copy_n(plane.view().row(y), source_.width, padded.data() + y * stride());
    Spectra::Spectrum whole;
    spectra_.forward(padded, whole);
    for (std::size_t i = 0; i < plane.texels().size(); ++i)
      energy_.texels()[i] += static_cast<double>(plane.texels()[i]) * plane.texels()[i];
    tbb::parallel_for(std::size_t{0}, placements_.size(), [&](std::size_t i) {
      Spectra::Plane target(area());
      shape_.forTexels([&](int x, int y) {
        const PointPx from = shape_.from(placements_[i], x, y);
        target[at(x, y)] = plane.at(from.x, from.y);
      });
      Spectra::Spectrum overlap;
      spectra_.forward(target, overlap);
      products_[i].resize(whole.size());
      for (std::size_t k = 0; k < whole.size(); ++k)
        products_[i][k] += whole[k] * std::conj(overlap[k]);
    });
  }

  // The corners of least cost, up to what is the same for all of them; the least first.
  std::vector<PointPx> least(std::size_t placement) const {
    Spectra::Plane common;
    spectra_.inverse(products_[placement], common);
    struct Cost {
      double cost;
      PointPx corner;
    };
    std::vector<Cost> costs;
    for (int y = 0; y + shape_.block.height <= source_.height; ++y)
      for (int x = 0; x + shape_.block.width <= source_.width; ++x)
        costs.push_back({overlapEnergy(x, y) - 2.0 * common[at(x, y)], {x, y}});
    const std::size_t count = std::min(kLeast, costs.size());
    std::partial_sort(costs.begin(), costs.begin() + static_cast<std::ptrdiff_t>(count),
                      costs.end(), [](const Cost& a, const Cost& b) { return a.cost < b.cost; });
    std::vector<PointPx> corners;
    for (std::size_t i = 0; i < count; ++i) corners.push_back(costs[i].corner);
    return corners;
  }

  // Once all planes are added, before least(): sums of energy over rectangles.
  void close() {
    sums_ = Image<double>(source_.width + 1, source_.height + 1, 1);
    for (int y = 0; y < source_.height; ++y)
      for (int x = 0; x < source_.width; ++x)
        sums_.at(x + 1, y + 1) =
            energy_.at(x, y) + sums_.at(x, y + 1) + sums_.at(x + 1, y) - sums_.at(x, y);
  }

 private:
  int stride() const { return spectra_.padded().width; }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride()) +
           static_cast<std::size_t>(x);
  }
  std::size_t area() const {
    return static_cast<std::size_t>(stride()) * static_cast<std::size_t>(spectra_.padded().height);
  }
  double energyOf(int x, int y, int width, int height) const {
    return sums_.at(x + width, y + height) - sums_.at(x, y + height) - sums_.at(x + width, y) +
           sums_.at(x, y);
  }
  double overlapEnergy(int x, int y) const {
    return energyOf(x, y, shape_.block.width, shape_.overlap.height) +
           energyOf(x, y + shape_.overlap.height, shape_.overlap.width,
                    shape_.block.height - shape_.overlap.height);
  }

  SizePx source_;
  Shape shape_;
  const std::vector<Placement>& placements_;
  Spectra spectra_;
  Image<double> energy_, sums_;
  std::vector<Spectra::Spectrum> products_;
};

}  // namespace

std::vector<HistoryRegret> historyRegret(const QuiltingSource& source,
                                         std::span<const float> weight, SizePx block,
                                         SizePx overlap, const std::vector<Placement>& placements,
                                         const std::vector<RankRegret>& chosen,
                                         Progress& progress) {
  const Shape shape{block, overlap};
  const Frames frames(source, weight);
  Correlations correlations(source.size(), shape, placements);
  frames.forPlanes(progress, [&](const Image<float>& plane) { correlations.add(plane); });
  correlations.close();
  std::vector<std::vector<PointPx>> corners(placements.size());  // the choices, then the least
  for (std::size_t i = 0; i < placements.size(); ++i) {
    for (const RankRegret& choice : chosen) corners[i].push_back(choice.choices[i]);
    const std::vector<PointPx> least = correlations.least(i);
    corners[i].insert(corners[i].end(), least.begin(), least.end());
  }
  std::vector<std::vector<double>> costs(placements.size());
  frames.forPlanes(progress, [&](const Image<float>& plane) {
    tbb::parallel_for(std::size_t{0}, placements.size(), [&](std::size_t i) {
      costs[i].resize(corners[i].size());
      shape.forTexels([&](int x, int y) {
        const PointPx from = shape.from(placements[i], x, y);
        const double wanted = plane.at(from.x, from.y);
        for (std::size_t k = 0; k < corners[i].size(); ++k) {
          const double apart = plane.at(corners[i][k].x + x, corners[i][k].y + y) - wanted;
          costs[i][k] += apart * apart;
        }
      });
    });
  });
  std::vector<HistoryRegret> regrets(chosen.size());
  for (std::size_t r = 0; r < chosen.size(); ++r) {
    for (const std::vector<double>& of_corners : costs) {
      const double least = *std::min_element(of_corners.begin(), of_corners.end());
      regrets[r].mean += least > 0 ? (of_corners[r] - least) / least : 0;
      regrets[r].same_share += of_corners[r] <= least;
    }
    regrets[r].mean /= static_cast<double>(placements.size());
    regrets[r].same_share /= static_cast<double>(placements.size());
  }
  return regrets;
}

}  // namespace patina::quilting
