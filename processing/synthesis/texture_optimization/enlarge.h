// SPDX-License-Identifier: GPL-3.0-or-later
// ST-BRDF sets of any size from a small one (Meister et al. 2021, section 6.1): polynomials of time
// are compared by the integral of their squared difference and averaged by their coefficients.
#pragma once

#include "processing/image/progress.h"
#include "processing/stbrdf/stbrdf_set.h"
#include "processing/synthesis/texture_optimization/optimize.h"

namespace patina::texture_optimization {

struct EnlargeOptions {
  OptimizeOptions optimize;
  // Of squared differences, a map; other maps follow without being compared.
  double diffuse = 1, specular = 1, roughness = 0;
  void check() const;  // throws ProcessingError(kUsage)
};

struct Enlarged {
  stbrdf::StbrdfSet set;
  OptimizedField field;
};

// Every map of the set, `options.optimize.size` texels large. Memory: the features (4 bytes a
// compared coefficient and source texel), the field and the result.
Enlarged enlarge(const stbrdf::StbrdfSet& set, const EnlargeOptions& options,
                 const Constraints& constraints, Progress& progress);

// Bytes that enlarge() will hold at once, for a forecast.
std::int64_t enlargeBytes(const stbrdf::StbrdfSet& set, SizePx size);

}  // namespace patina::texture_optimization
