// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/time_control.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "capture/workflow/failure.h"
#include "capture/workflow/grey_picture.h"
#include "processing/image/expression.h"

namespace patina::workflow {
namespace {

constexpr int kRateKeys = 33;  // of a rate that changes over time
constexpr int kShadowRays = 32;

const std::vector<std::string>& variableNames() {
  static const std::vector<std::string> names{"x",     "y",         "t",     "map",    "height",
                                              "slope", "curvature", "light", "shadow", "sky"};
  return names;
}

bool isMoving(const std::string& name) { return name == "light" || name == "shadow"; }

// The planes that formulas name, each made when it is first asked for.
class Planes {
 public:
  Planes(const TimeControl& control, const ttf::TtfInfo& input)
      : control_(control),
        size_{input.width, input.height},
        mm_per_texel_(control.mm_per_texel > 0 ? control.mm_per_texel : input.mm_per_texel),
        moves_(control.lamp && control.lamp->moves()) {}

  bool change(const std::set<std::string>& used) const {
    return used.contains("t") || (moves_ && std::any_of(used.begin(), used.end(), isMoving));
  }

  // Until the next call with another t, of a lamp that moves.
  const Image<float>& at(const std::string& name, double t) {
    if (moves_ && isMoving(name) && t != moved_t_) {
      planes_.erase("light");
      planes_.erase("shadow");
      moved_t_ = t;
    }
    const auto [it, is_new] = planes_.try_emplace(name);
    if (is_new) it->second = make(name, t);
    return it->second;
  }

 private:
  Image<float> make(const std::string& name, double t) {
    if (name == "map") {
      need(!control_.map.empty(), name, "a picture: --map FILE");
      return greyPicture(control_.map, size_);
    }
    if (name == "height" && !control_.mesh && mm_per_texel_ <= 0) return heights();
    const ControlSurface& surface = surfaceFor(name);
    if (name == "height") return surface.height();
    if (name == "slope") return surface.slope();
    if (name == "curvature") return surface.curvature();
    if (name == "sky") return surface.sky();
    need(control_.lamp.has_value(), name, "a light: --light X,Y,Z or --lamp X,Y,Z");
    const mesh::Lamp lamp = control_.lamp->lampAt(t);
    const double radius = control_.lamp->radius;
    if (name == "shadow") return surface.shadow(lamp, {radius, radius > 0 ? kShadowRays : 1});
    Image<float> light = surface.light(lamp);
    for (float& v : light.texels()) v /= brightest(surface);
    return light;
  }

  // Of all texels at all times that rates are worked out for.
  float brightest(const ControlSurface& surface) {
    if (brightest_ > 0) return brightest_;
    for (int k = 0; k < (moves_ ? kRateKeys : 1); ++k) {
      const Image<float> light = surface.light(control_.lamp->lampAt(k / (kRateKeys - 1.0)));
      brightest_ =
          std::max(brightest_, *std::max_element(light.texels().begin(), light.texels().end()));
    }
    if (!(brightest_ > 0)) throw WorkflowError(Exit::kUsage, "the light reaches no texel");
    return brightest_;
  }

  Image<float> heights() {
    if (control_.height.empty()) return Image<float>(size_.width, size_.height, 1);  // flat
    Image<float> out = greyPicture(control_.height, size_);
    for (float& v : out.texels()) v *= static_cast<float>(control_.height_mm);
    return out;
  }

  const ControlSurface& surfaceFor(const std::string& name) {
    if (!surface_ && control_.mesh)
      surface_ = surfaceOfMesh(control_.mesh, size_, control_.casters);
    if (!surface_) {
      need(mm_per_texel_ > 0, name, "the size of a texel: --mm-per-texel X");
      surface_ = surfaceOfRelief(heights(), mm_per_texel_, control_.casters);
    }
    return *surface_;
  }

  static void need(bool there, const std::string& name, const std::string& what) {
    if (!there) throw WorkflowError(Exit::kUsage, "'" + name + "' needs " + what);
  }

  const TimeControl& control_;
  SizePx size_;
  double mm_per_texel_;
  bool moves_;
  double moved_t_ = -1;
  float brightest_ = 0;
  std::unique_ptr<ControlSurface> surface_;
  std::map<std::string, Image<float>> planes_;
};

Image<float> worked(const std::string& formula, SizePx size, double t, Planes& planes) {
  Expression expression(formula, variableNames());
  std::vector<const Image<float>*> used;
  for (const std::string& name : variableNames())
    used.push_back(name.size() > 1 && expression.used().contains(name) ? &planes.at(name, t)
                                                                       : nullptr);
  Image<float> out(size.width, size.height, 1);
  const double half = std::min(size.width, size.height) / 2.0;
  std::vector<double> values(used.size());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      values[0] = (x + 0.5 - size.width / 2.0) / half;
      values[1] = (size.height / 2.0 - y - 0.5) / half;
      values[2] = t;
      for (std::size_t i = 3; i < used.size(); ++i)
        if (used[i]) values[i] = used[i]->at(x, y);
      out.at(x, y) = static_cast<float>(expression.at(values));
      if (!(out.at(x, y) >= 0))
        throw WorkflowError(Exit::kUsage,
                            "'" + formula + "' is " + std::to_string(out.at(x, y)) + " at texel " +
                                std::to_string(x) + "," + std::to_string(y) +
                                "; a texel ages forwards: keep it at 0 or more, as max(0, ...) "
                                "does");
    }
  return out;
}

// Spreads the keys of a rate that changes over the result, whose length is, unless it was given,
// that after which the texel that ages most has come to its end.
void stretch(ttf::RetimeOptions& options, const ttf::TtfInfo& input, double length_s) {
  const std::size_t keys = options.rates.size();
  double greatest = 0, most = 0;  // of all rates; of the texels' means over time
  for (std::size_t i = 0; i < options.rates[0].rate.texels().size(); ++i) {
    double sum = 0;
    for (std::size_t k = 0; k < keys; ++k) {
      const double rate = options.rates[k].rate.texels()[i];
      greatest = std::max(greatest, rate);
      sum += k == 0 || k + 1 == keys ? rate / 2 : rate;
    }
    most = std::max(most, sum / static_cast<double>(keys - 1));
  }
  if (!options.duration_s && most > 0) {
    // Frames come as captured, of the fastest texel: the last one shows the end.
    const double unit = options.fastest_as_captured ? greatest : 1, steps = input.frames - 1.0;
    options.duration_s =
        std::ceil(steps * greatest / most - 1e-9) * length_s * unit / (steps * greatest);
  }
  for (std::size_t k = 0; k < keys; ++k)
    options.rates[k].time_s =
        options.duration_s.value_or(length_s) * static_cast<double>(k) / (keys - 1.0);
}

// Parts between the commas that lie in no bracket.
std::vector<std::string> splitFormulas(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text) {
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (c == ',' && depth == 0)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

}  // namespace

MovingLamp MovingLamp::parse(const std::string& text, bool directional) {
  const std::vector<std::string> parts = splitFormulas(text);
  if (parts.size() != 3)
    throw WorkflowError(Exit::kUsage,
                        "a light is three numbers, or formulas of t, such as "
                        "0.5,0.2,0.8; not '" +
                            text + "'");
  MovingLamp lamp{directional, {parts[0], parts[1], parts[2]}, 0};
  lamp.lampAt(0);
  return lamp;
}

mesh::Lamp MovingLamp::lampAt(double t) const {
  mesh::Lamp lamp{directional, {}};
  for (std::size_t c = 0; c < 3; ++c) {
    lamp.at[c] = Expression(at[c], {"t"}).at({t});
    if (!(std::abs(lamp.at[c]) <= 1e9))
      throw WorkflowError(Exit::kUsage, "a light's '" + at[c] + "' is no number within 1e9");
  }
  return lamp;
}

bool MovingLamp::moves() const {
  return std::any_of(at.begin(), at.end(), [](const std::string& formula) {
    return Expression(formula, {"t"}).used().contains("t");
  });
}

void controlTime(const TimeControl& control, const ttf::TtfInfo& input, ttf::RetimeOptions& options,
                 Progress& progress) {
  const std::string rate = !control.rate.empty() ? control.rate : control.map.empty() ? "" : "map";
  if (rate.empty() && control.start.empty())
    throw WorkflowError(Exit::kUsage,
                        "how fast should what age? Give --rate FORMULA, --start FORMULA or --map "
                        "FILE");
  Planes planes(control, input);
  const SizePx size{input.width, input.height};
  const double length_s = input.time_s.back() - input.time_s.front();
  options.rates.clear();
  if (!rate.empty()) {
    const bool changes = planes.change(Expression(rate, variableNames()).used());
    const int keys = changes ? kRateKeys : 1;
    progress.begin("rates", keys);
    for (int k = 0; k < keys; ++k) {
      options.rates.push_back({0, worked(rate, size, k / (kRateKeys - 1.0), planes)});
      progress.step();
    }
    if (changes) stretch(options, input, length_s);
  }
  if (control.start.empty()) return;
  options.start_s = worked(control.start, size, 0, planes);
  for (float& v : options.start_s.texels()) v *= static_cast<float>(length_s);
}

}  // namespace patina::workflow
