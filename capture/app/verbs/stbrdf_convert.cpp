// SPDX-License-Identifier: GPL-3.0-or-later
// patina stbrdf convert: between the forms that hold a changing material.
#include "capture/app/verbs/stbrdf_verbs.h"
#include "processing/stbrdf/staf_file.h"
#include "processing/stbrdf/stbrdf_file.h"

namespace patina::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string in, out, basis;
  int degree = stbrdf::kStafDegree;
};

// A folder of STAF's factors has files that end so.
bool isStaf(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (entry.path().filename().string().ends_with("staf-Kd-phi.txt")) return true;
  return false;
}

void convertSet(Context& context, const Options& options) {
  refuseThatIsThere({options.out});
  stbrdf::StbrdfSet set = isStaf(options.in)
                              ? stbrdf::stafPolynomials(stbrdf::readStafSet(options.in),
                                                        options.degree, context.progress)
                              : stbrdf::readStbrdfSet(options.in, context.progress);
  if (!options.basis.empty()) {
    const stbrdf::Basis basis = stbrdf::basisNamed(options.basis);
    if (basis == stbrdf::Basis::kMonomial && set.degree > stbrdf::kMonomialDegreeMax)
      throw AppError(Exit::kUsage, "monomials in float32 hold at most degree " +
                                       std::to_string(stbrdf::kMonomialDegreeMax) + "; this is " +
                                       std::to_string(set.degree));
    stbrdf::convert(set, basis);
  }
  stbrdf::writeStbrdfSet(options.out, set, context.progress);
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", options.out.c_str())
                                .set("degree", set.degree)
                                .set("basis", nameOf(set.basis).c_str())
                                .set("maps", set.maps.size())
                                .set("width_px", set.size().width)
                                .set("height_px", set.size().height)));
}

}  // namespace

void addStbrdfConvertVerb(Verb stbrdf) {
  auto o = std::make_shared<Options>();
  stbrdf
      .verb("convert", "From the authors' folders, STAF's factors or another basis to a set",
            "patina stbrdf convert snowyground --out snow",
            [o](Context& context) { convertSet(context, *o); })
      .required("IN", o->in, "A folder of coefficients, or of STAF's factors")
      .option("--basis", o->basis, "monomial|shifted-legendre", "Of the result (default: as it is)")
      .option("--degree", o->degree, 0, stbrdf::kDegreeMax,
              "Of polynomials fitted to a STAF database's folder (default: 6)")
      .option("--out", o->out, "SET", "The folder to write")
      .demand("--out");
}

}  // namespace patina::app
