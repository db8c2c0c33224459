// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/reflectance_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "capture/workflow/gain_field_calibration.h"
#include "db/archive.h"
#include "devices/twin/lamp_field.h"
#include "devices/twin/lit_scene.h"
#include "devices/twin/shading.h"
#include "processing/brdf/picture_score.h"
#include "processing/brdf/relight.h"
#include "tests/support/child.h"
#include "tests/system/reflectance_bound.h"
#include "tests/system/reflectance_dome.h"

namespace patina::testing {
namespace {

namespace twin = devices::twin;
namespace fs = std::filesystem;

struct RmsOf {
  double square = 0;
  long count = 0;
  void add(double off2) { square += off2, ++count; }
  double rms() const { return count ? std::sqrt(square / static_cast<double>(count)) : 0; }
};

// The world as the program's twin has it, for its truth and its lamps.
class Truth {
 public:
  explicit Truth(const Loop& loop)
      : loop_(loop),
        rig_(wholeRig(loop, false)),
        layout_(twin::pictureLayout(rig_, rig_.cameras.front())),
        world_(rig_, options(loop), clock_),
        scene_(world_, layout_, {}, {}),
        shadowed_world_(wholeRig(loop, loop.shadows), options(loop), clock_),
        shadowed_(shadowed_world_, layout_, {}, {}) {
    rect_ = layout_.specimen_px;
    rect_.width -= rect_.width % loop.bin;
    rect_.height -= rect_.height % loop.bin;
    grid_.size = {rect_.width, rect_.height};
    const twin::SampleGrid& whole = scene_.grid();
    grid_.texel_mm = whole.texel_mm;
    for (int y = 0; y < rect_.height; ++y)
      for (int x = 0; x < rect_.width; ++x) {
        const std::size_t k = whole.index(rect_.x + x, rect_.y + y);
        grid_.x_mm.push_back(whole.x_mm[k]);
        grid_.y_mm.push_back(whole.y_mm[k]);
      }
    view_.emplace(grid_);
    surface_ = world_.specimen().prepare(grid_);
  }

  const RectPx& rect() const { return rect_; }
  // With its border: what does not age in a frame.
  RectPx patch() const {
    const RectPx& inner = layout_.patch_px;
    const int border = twin::patchBorderPx(inner), x = std::max(0, inner.x - border),
              y = std::max(0, inner.y - border);
    return {x, y, std::min(inner.x + inner.width + border, loop_.side_px) - x,
            std::min(inner.y + inner.height + border, loop_.side_px) - y};
  }
  // Of texels: the mean of their pixels.
  brdf::BrdfMaps maps(double time) const {
    const twin::SurfaceMaps fine = mapsAt(*surface_, time, grid_.size);
    brdf::BrdfMaps maps{meansOf(fine.diffuse),
                        meansOf(fine.specular),
                        meansOf(fine.roughness),
                        meansOf(fine.normal),
                        {}};
    for (int y = 0; y < maps.normal.height(); ++y)
      for (int x = 0; x < maps.normal.width(); ++x) {
        const auto n = maps.normal.view().texel(x, y);
        const brdf::Vec3 unit = brdf::normalized({n[0], n[1], n[2]});
        n[0] = unit.x, n[1] = unit.y, n[2] = unit.z;
      }
    return maps;
  }
  float mmPerTexel() const {
    return static_cast<float>(viewMm(loop_) / layout_.size.width * loop_.bin);
  }

  // Over the region's own middle, as the fit has it.
  brdf::SurfaceLight light(int lamp) const {
    const auto& at = rig_.lights[static_cast<std::size_t>(lamp)].position_mm;
    const double m = mmPerTexel() / loop_.bin;
    const double x = (rect().x + rect().width / 2.0 - layout_.size.width / 2.0) * m,
                 y = (layout_.size.height / 2.0 - rect().y - rect().height / 2.0) * m;
    brdf::SurfaceLight light;
    light.near = true;
    light.position_mm = {static_cast<float>(at[0] - x), static_cast<float>(at[1] - y),
                         static_cast<float>(at[2])};
    light.strength = static_cast<float>(kDistanceMm * kDistanceMm * kDistanceMm / at[2]);
    return light;
  }

  TexelExposure exposure() const {
    const twin::SensorProfile& sensor = world_.profile().sensor;
    return {sensor.full_well * sensor.grey_fill / sensor.grey_reflectance, sensor.full_well,
            sensor.read_noise, loop_.bin * loop_.bin * loop_.frames};
  }

  // The share of every lamp's light that no cast shadow takes from a pixel.
  std::vector<Image<float>> lit(double time) {
    const std::vector<bool> all(static_cast<std::size_t>(lampsOf(loop_)), true);
    scene_.render(time, all);
    shadowed_.render(time, all);
    std::vector<Image<float>> out;
    for (std::size_t lamp = 0; lamp < all.size(); ++lamp) {
      Image<float>& share = out.emplace_back(grid_.size.width, grid_.size.height, 1, 1.0f);
      for (int y = 0; y < grid_.size.height; ++y)
        for (int x = 0; x < grid_.size.width; ++x) {
          const std::size_t k = scene_.grid().index(rect_.x + x, rect_.y + y);
          const float whole = scene_.lamp(lamp)[k];
          if (whole > 0) share.at(x, y) = shadowed_.lamp(lamp)[k] / whole;
        }
    }
    return out;
  }

  // Noiseless, without mosaic; of every pixel the share `lit`.
  Image<float> picture(double time, int lamp, const Image<float>& lit) const {
    const twin::LampField field(*view_, world_.lampPlace(static_cast<std::size_t>(lamp)), true);
    Image<float> pixels(grid_.size.width, grid_.size.height, 3);
    std::vector<float> scratch, channel(static_cast<std::size_t>(grid_.size.width));
    twin::SurfaceRow row(grid_.size.width);
    for (int y = 0; y < grid_.size.height; ++y) {
      surface_->rowAt(time, y, row);
      const twin::ShadedRow shaded{row, field.row(y, scratch), view_->viewRow(y),
                                   world_.specimen().measured()};
      for (int c = 0; c < 3; ++c) {
        twin::shadeChannelRow(shaded, c, channel.data());
        for (int x = 0; x < grid_.size.width; ++x)
          pixels.at(x, y, c) = lit.at(x, y) * channel[static_cast<std::size_t>(x)];
      }
    }
    return meansOf(pixels);
  }

  // Of texels.
  Image<float> meansOf(const Image<float>& pixels) const {
    const int n = loop_.bin;
    Image<float> out(pixels.width() / n, pixels.height() / n, pixels.channels());
    for (int y = 0; y < pixels.height(); ++y)
      for (int x = 0; x < pixels.width(); ++x)
        for (int c = 0; c < pixels.channels(); ++c)
          out.at(x / n, y / n, c) += pixels.at(x, y, c) / static_cast<float>(n * n);
    return out;
  }

 private:
  static twin::TwinOptions options(const Loop& loop) {
    twin::TwinOptions options;
    options.seed = 1;
    options.duration = std::chrono::seconds(intervalOf(loop)) * loop.steps;
    return options;
  }

  const Loop& loop_;
  devices::RigSpec rig_;
  twin::PictureLayout layout_;
  RectPx rect_;
  devices::VirtualClock clock_{UtcTime{}};
  twin::World world_;
  twin::LitScene scene_;  // without cast shadows
  twin::World shadowed_world_;
  twin::LitScene shadowed_;
  twin::SampleGrid grid_;  // of pixels
  std::optional<twin::CameraView> view_;
  std::shared_ptr<const twin::PreparedSurface> surface_;
};

bool isWithinLobe(const brdf::SurfaceLight& light, const brdf::PlaceMm& at,
                  std::span<const float> n, float alpha) {
  const brdf::LightRay ray = brdf::rayAt(light, {0, 0, 1}, at.x, at.y);
  const float n_h = brdf::dot(ray.h, {n[0], n[1], n[2]});
  return n_h > 0 && std::sqrt(1 - std::min(1.0f, n_h * n_h)) <= alpha * n_h;
}

class Judge {
 public:
  explicit Judge(const Loop& loop) : truth_(loop) {
    for (int i = 0; i < lampsOf(loop); ++i) (isLeftOut(loop, i) ? left_out_ : used_).push_back(i);
    for (const int lamp : used_) lights_.push_back(truth_.light(lamp));
  }

  void judge(double time, const brdf::BrdfMaps& seen, const brdf::BrdfSetInfo& info) {
    const brdf::BrdfMaps want = truth_.maps(time);
    ASSERT_EQ(seen.diffuse.size(), want.diffuse.size());
    lit_ = truth_.lit(time);
    reach_.clear();
    for (const Image<float>& lit : lit_) reach_.push_back(truth_.meansOf(lit));
    for (int y = 0; y < want.diffuse.height(); ++y)
      for (int x = 0; x < want.diffuse.width(); ++x) judgeTexel(want, seen, x, y);
    judgePictures(time, seen, info, pictures_, &psnr_worst_);
    judgePictures(time, want, {}, of_truth_, nullptr);
    for (Image<float>& lit : lit_) lit = Image<float>(lit.width(), lit.height(), 1, 1.0f);
    for (Image<float>& share : reach_) share = Image<float>(share.width(), share.height(), 1, 1.0f);
    judgePictures(time, seen, info, unshadowed_, nullptr);
  }

  LoopScore score() {
    LoopScore out;
    out.diffuse_rms = diffuse_.rms();
    std::nth_element(angles_.begin(), angles_.begin() + static_cast<long>(angles_.size() / 2),
                     angles_.end());
    out.normal_median_deg = angles_[angles_.size() / 2];
    out.psnr_db = -20 * std::log10(pictures_.rms());
    out.psnr_worst_db = psnr_worst_;
    out.psnr_truth_db = -20 * std::log10(of_truth_.rms());
    out.psnr_unshadowed_db = -20 * std::log10(unshadowed_.rms());
    out.told_share = static_cast<double>(told_s_.count) / static_cast<double>(angles_.size());
    out.bound_diffuse_rms = bound_d_.rms(), out.bound_specular_rms = bound_s_.rms();
    out.bound_alpha_rms = bound_a_.rms();
    out.told_specular_rms = told_s_.rms(), out.told_alpha_rms = told_a_.rms();
    out.sure_share =
        static_cast<double>(sure_s_.count) / static_cast<double>(std::max(1L, told_s_.count));
    out.sure_specular_rms = sure_s_.rms(), out.sure_alpha_rms = sure_a_.rms();
    out.unsure_specular_rms = unsure_s_.rms(), out.unsure_alpha_rms = unsure_a_.rms();
    return out;
  }

 private:
  void judgeTexel(const brdf::BrdfMaps& want, const brdf::BrdfMaps& seen, int x, int y) {
    double specular2 = 0;
    for (int c = 0; c < 3; ++c) {
      const double d = double{seen.diffuse.at(x, y, c)} - want.diffuse.at(x, y, c),
                   s = double{seen.specular.at(x, y, c)} - want.specular.at(x, y, c);
      diffuse_.add(d * d);
      specular2 += s * s / 3;
    }
    const auto p = seen.normal.view().texel(x, y), q = want.normal.view().texel(x, y);
    const double cosine = double{p[0]} * q[0] + double{p[1]} * q[1] + double{p[2]} * q[2];
    angles_.push_back(std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI);
    const float alpha = want.roughness.at(x, y);
    const double a = double{seen.roughness.at(x, y)} - alpha;
    const bool sure = seen.extra.at("Confidence").at(x, y) >= 0.5f;
    const brdf::PlaceMm at = brdf::placeOf(x, y, want.diffuse.size(), truth_.mmPerTexel());
    int tell = 0;
    std::vector<brdf::LightRay> rays;
    for (std::size_t i = 0; i < used_.size(); ++i) {
      if (reach_[static_cast<std::size_t>(used_[i])].at(x, y) < 0.5f) continue;
      tell += isWithinLobe(lights_[i], at, q, alpha);
      rays.push_back(brdf::rayAt(lights_[i], {0, 0, 1}, at.x, at.y));
    }
    const auto grey = [&](const Image<float>& map) {
      return (double{map.at(x, y, 0)} + map.at(x, y, 1) + map.at(x, y, 2)) / 3;
    };
    const ReflectanceBound bound =
        boundOf({grey(want.diffuse), grey(want.specular), alpha, {q[0], q[1], q[2]}}, rays,
                truth_.exposure());
    bound_d_.add(bound.diffuse * bound.diffuse);
    if (tell < 3) return;
    bound_s_.add(bound.specular * bound.specular), bound_a_.add(bound.alpha * bound.alpha);
    told_s_.add(specular2), told_a_.add(a * a);
    (sure ? sure_s_ : unsure_s_).add(specular2);
    (sure ? sure_a_ : unsure_a_).add(a * a);
  }

  void judgePictures(double time, const brdf::BrdfMaps& seen, const brdf::BrdfSetInfo& info,
                     RmsOf& all, double* worst_db) const {
    for (const int lamp : left_out_) {
      const auto l = static_cast<std::size_t>(lamp);
      const Image<float> want = truth_.picture(time, lamp, lit_[l]);
      const Image<float> picture =
          brdf::relight(seen, info, truth_.light(lamp), {0, 0, 1}, truth_.mmPerTexel());
      RmsOf own;
      for (std::size_t k = 0; k < want.texels().size(); ++k) {
        const float shaded = picture.texels()[k] * reach_[l].texels()[k / 3];
        const double off =
            std::clamp(shaded, 0.0f, 1.0f) - std::clamp(want.texels()[k], 0.0f, 1.0f);
        own.add(off * off), all.add(off * off);
      }
      if (worst_db) *worst_db = std::min(*worst_db, -20 * std::log10(own.rms()));
    }
  }

  Truth truth_;
  std::vector<int> used_, left_out_;
  std::vector<brdf::SurfaceLight> lights_;
  std::vector<Image<float>> lit_, reach_;  // by pixel, and its mean by texel, of every lamp
  RmsOf bound_d_, bound_s_, bound_a_;
  RmsOf diffuse_, pictures_, of_truth_, unshadowed_, told_s_, told_a_, sure_s_, sure_a_, unsure_s_,
      unsure_a_;
  std::vector<double> angles_;
  double psnr_worst_ = HUGE_VAL;
};

std::string afterText(const Loop& loop, const RectPx& patch) {
  std::string text = "[after]\nsteps = [\"brdf\", \"stbrdf\"]\nbin = " + std::to_string(loop.bin) +
                     "\ndegree = " + std::to_string(std::min(loop.degree, loop.steps - 1)) + "\n";
  if (loop.registered) text += "register = \"translation\"\n";
  if (loop.by_patch)
    text += "fiducial = [" + std::to_string(patch.x) + ", " + std::to_string(patch.y) + ", " +
            std::to_string(patch.width) + ", " + std::to_string(patch.height) + "]\n";
  return text;
}

}  // namespace

std::string planOf(const TempFolder& folder) { return folder / "plan.toml"; }
std::string archiveOf(const TempFolder& folder) { return folder / "archive"; }

void prepareLoop(const Loop& loop, const TempFolder& folder) {
  const Truth truth(loop);
  Loop card = loop;
  card.frames = 1;
  writeFile(folder / "rig.toml", rigText(loop, Card::kNone, false));
  writeFile(folder / "noise_rig.toml", rigText(loop, Card::kAllOver, false));
  writeFile(folder / "card_rig.toml", rigText(loop, Card::kBesideThePatch, false));
  writeFile(folder / "plan.toml", planText(loop, "rig.toml", plainName(loop.specimen), loop.steps,
                                           afterText(loop, truth.patch())));
  writeFile(folder / "card.toml", planText(card, "card_rig.toml", "card", 4 * loop.frames,
                                           "[light_check]\nmode = \"uncontrolled\"\n"));
  if (loop.bump_px > 0) writeFile(folder / "faults.toml", bumpText(loop));
  writeFile(folder / "noise.toml", noisePlanText("noise_rig.toml"));
  for (const std::vector<std::string>& args :
       {std::vector<std::string>{"rehearse", folder / "noise.toml"},
        {"calibrate", "noise", "latest", "--light", idOf(0)},
        {"rehearse", folder / "card.toml"}}) {
    std::vector<std::string> all = args;
    all.insert(all.end(), {"--archive", archiveOf(folder)});
    const Finished done = runPatina(all);
    ASSERT_EQ(done.exit, 0) << done.err;
  }
  const RectPx& r = truth.rect();
  Progress progress;
  for (int lamp = 0; lamp < lampsOf(loop); ++lamp) {
    if (isLeftOut(loop, lamp)) continue;
    workflow::GainFieldRequest request;
    request.pictures.run = "latest";
    request.pictures.selection.light = idOf(lamp);
    request.target = {r};
    request.reflectance = kCardReflectance;
    const UtcTime now{};
    keepGainField(archiveOf(folder), request,
                  makeGainField(archiveOf(folder), request, now, progress), now);
  }
}

std::string setOf(const TempFolder& folder, const std::string& kind) {
  const db::ArchiveReader reader(archiveOf(folder));
  const auto rows = reader.products(kind);
  if (rows.empty()) return {};
  return db::ProductWriter::folderFor(archiveOf(folder), rows.back().id);
}

LoopScore scoreOf(const Loop& loop, const TempFolder& folder) {
  const fs::path set = setOf(folder, "brdf");
  const brdf::BrdfSetInfo info = brdf::readBrdfSetInfo(set);
  Judge judge(loop);
  for (int step = 0; step < info.steps(); ++step) {
    const double share =
        info.times[static_cast<std::size_t>(step)] / (intervalOf(loop) * loop.steps);
    judge.judge(share, brdf::readBrdfMaps(set, info, step), info);
  }
  return judge.score();
}

}  // namespace patina::testing
