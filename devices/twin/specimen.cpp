// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/specimen.h"

#include "devices/twin/paired_processes.h"
#include "devices/twin/row_loop.h"
#include "devices/twin/specimens.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

struct Kind {
  const SpecimenInfo& (*info)();
  std::unique_ptr<Specimen> (*make)(std::uint64_t seed);
};
constexpr Kind kKinds[] = {
    {bananaInfo, makeBanana}, {copperInfo, makeCopper},     {grassInfo, makeGrass},
    {paintInfo, makePaint},   {snowInfo, makeSnow},         {steelInfo, makeSteel},
    {woodInfo, makeWood},     {greyCardInfo, makeGreyCard},
};

}  // namespace

SampleGrid SampleGrid::regular(SizePx size, double width_mm) {
  SampleGrid grid;
  grid.size = size;
  const double texel = width_mm / size.width;
  grid.texel_mm = static_cast<float>(texel);
  const auto count = static_cast<std::size_t>(size.width) * size.height;
  grid.x_mm.resize(count);
  grid.y_mm.resize(count);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      grid.x_mm[grid.index(x, y)] = static_cast<float>((x + 0.5 - size.width * 0.5) * texel);
      grid.y_mm[grid.index(x, y)] = static_cast<float>((size.height * 0.5 - y - 0.5) * texel);
    }
  return grid;
}

std::vector<SpecimenInfo> listSpecimens() {
  std::vector<SpecimenInfo> infos;
  for (const Kind& kind : kKinds) infos.push_back(kind.info());
  return infos;
}

std::unique_ptr<Specimen> makeSpecimen(const std::string& name, std::uint64_t seed) {
  if (const std::size_t plus = name.find('+'); plus != std::string::npos)
    return pairProcesses(makeSpecimen(name.substr(0, plus), seed),
                         makeSpecimen(name.substr(plus + 1), hashSeed(seed, 0x2a1full)));
  std::string known;
  for (const Kind& kind : kKinds) {
    if (kind.info().name == name) return kind.make(seed);
    known += (known.empty() ? "" : ", ") + kind.info().name;
  }
  throw ProcessingError(Exit::kUsage, "no specimen '" + name + "'; there are: " + known);
}

SurfaceMaps mapsAt(const PreparedSurface& surface, double time, SizePx size) {
  SurfaceMaps maps;
  maps.diffuse = Image<float>(size.width, size.height, 3);
  maps.specular = Image<float>(size.width, size.height, 3);
  maps.normal = Image<float>(size.width, size.height, 3);
  maps.roughness = Image<float>(size.width, size.height, 1);
  maps.height = Image<float>(size.width, size.height, 1);
  maps.degree = Image<float>(size.width, size.height, 1);
  forRowBlocks(size, [&](int y0, int y1) {
    SurfaceRow row(size.width);
    const auto interleave = [&](Image<float>& to, int y, SurfaceRow::Channel first) {
      float* out = to.view().row(y);
      const float *a = row[first], *b = a + size.width, *c = b + size.width;
      for (int x = 0; x < size.width; ++x) {
        out[3 * x] = a[x];
        out[3 * x + 1] = b[x];
        out[3 * x + 2] = c[x];
      }
    };
    for (int y = y0; y < y1; ++y) {
      surface.rowAt(time, y, row);
      interleave(maps.diffuse, y, SurfaceRow::kDiffuseR);
      interleave(maps.specular, y, SurfaceRow::kSpecularR);
      interleave(maps.normal, y, SurfaceRow::kNormalX);
      std::copy_n(row[SurfaceRow::kRoughness], size.width, maps.roughness.view().row(y));
      std::copy_n(row[SurfaceRow::kHeight], size.width, maps.height.view().row(y));
      std::copy_n(row[SurfaceRow::kDegree], size.width, maps.degree.view().row(y));
    }
  });
  return maps;
}

SurfaceMaps RegularSurface::at(const Specimen& specimen, double time, SizePx size) {
  std::shared_ptr<const PreparedSurface> surface;
  {
    const std::lock_guard lock(mutex_);
    if (!surface_ || size != size_) {
      surface_ = specimen.prepare(SampleGrid::regular(size, specimen.info().width_mm));
      size_ = size;
    }
    surface = surface_;
  }
  return mapsAt(*surface, time, size);
}

}  // namespace patina::devices::twin
