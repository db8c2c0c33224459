// SPDX-License-Identifier: GPL-3.0-or-later
// A specular lobe with its derivatives, as fits want it: the same form for every model.
//
//   f_s = scale * value                       Ward, Torrance-Sparrow: scale = specular reflectance
//   f_s = (f0 + (1 - f0) m) * value           GGX: m = Schlick's weight, f0 = specular reflectance
//
// value and its derivatives depend on n.l, n.v, n.h, v.h and the roughness alone. v.h does not
// depend on the normal. Inline, free of branches and of calls.
#pragma once

namespace patina::brdf {

struct LobeCosines {
  float n_l, n_v, n_h, v_h;  // in (0, 1]
};

struct Lobe {
  float value = 0;                                         // [1/sr]
  float by_n_l = 0, by_n_v = 0, by_n_h = 0, by_log_r = 0;  // partial derivatives; r: roughness
};

}  // namespace patina::brdf
