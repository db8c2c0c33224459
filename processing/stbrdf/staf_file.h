// SPDX-License-Identifier: GPL-3.0-or-later
// Folders of factors as in the database of Gu et al. 2006, one channel of one map being
//
//   p(t) = A phi((t - C) / B) + D        so that R = 1 / B and O = C / B (staf.h)
//
//   *staf-Kd-A.exr *staf-Kd-B.exr *staf-Kd-C.exr *staf-Kd-D.exr    and Ks, Sigma likewise
//   *staf-Kd-phi.txt      lines pphi_r:, pphi_g:, pphi_b: with coefficients, highest power first
//   *staf-Ks-phi.txt      lines pphi_Ks: and pphi_S: (of Sigma)
//
// In the database Sigma is 1 / sigma^2 and Ks is coupled with the lobe's width (Meister et al.
// 2021, eq. 9): stafPolynomials() undoes both. Our own folders say in manifest.json that Ks and
// Sigma are Specular and Roughness as they are.
#pragma once

#include <filesystem>
#include <vector>

#include "processing/stbrdf/staf.h"

namespace patina::stbrdf {

struct StafSet {
  std::vector<StafMap> maps;  // "Diffuse" "Specular" "Roughness"
  bool as_measured = false;   // the database's Ks and Sigma
  std::string model = "torrance-sparrow", roughness = "sigma";
};

// Throws ProcessingError(kBadData): a factor missing, sizes that differ, a value that is no number,
// a curve that cannot be read.
StafSet readStafSet(const std::filesystem::path& folder);
// The folder appears whole or not at all; Diffuse, Specular and Roughness only.
void writeStafSet(const std::filesystem::path& folder, const StafSet& set);

// The set as polynomials: exact for our own folders (degree 6); for the database's, fitted to 50
// even times.
StbrdfSet stafPolynomials(const StafSet& set, int degree, Progress& progress);

}  // namespace patina::stbrdf
