// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/colour_fit.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "calibration/colour/delta_e.h"
#include "calibration/failure.h"

namespace patina::calibration {
namespace {

using Matrix = cv::Mat_<double>;

constexpr double kAsGood = 1.05;  // fewer numbers are taken at an error higher by so much
constexpr int kIterationsLeftOut = 30;
constexpr int kGreen = 1;  // the term that gives way where white is preserved

// The fields as a fit sees them: predicted XYZ = terms * M + constant, M being [terms][3].
struct Problem {
  Matrix terms;     // [fields][terms]
  Matrix constant;  // [fields][3]
  Matrix wanted;    // [fields][3], XYZ
  std::vector<Lab> expected;

  Matrix colours(const Matrix& m) const { return terms * m + constant; }
};

// White preserved: the coefficients of green are what white needs beside all others,
// m_g = (W - sum m_j t_j(w)) / t_g(w), so that green leaves the problem.
struct WhiteRule {
  bool used = false;
  Matrix share;     // t_j(w) / t_g(w), [1][terms]
  Matrix of_green;  // W / t_g(w), [1][3]
};

class Chart {
 public:
  Chart(const SeenColours& seen, const ChartColours& expected, FitKind kind, bool preserve_white)
      : kind_(kind),
        count_(termCount(kind)),
        terms_(kChartFields, count_),
        wanted_(kChartFields, 3) {
    // White's green is 1: the terms are of one size, and offsets of the others'.
    scale_ = 1 / seen[kWhiteField][kGreen];
    for (int i = 0; i < kChartFields; ++i) {
      std::array<double, kTermsMax> terms{};
      fillTerms(kind, {seen[i][0] * scale_, seen[i][1] * scale_, seen[i][2] * scale_}, terms);
      std::copy_n(terms.begin(), count_, terms_[i]);
      const Xyz xyz = xyzOf(expected[i]);
      wanted_(i, 0) = xyz.x, wanted_(i, 1) = xyz.y, wanted_(i, 2) = xyz.z;
    }
    expected_.assign(expected.begin(), expected.end());
    if (!preserve_white) return;
    const double green = terms_(kWhiteField, kGreen);
    white_ = {true, terms_.row(kWhiteField) / green, wanted_.row(kWhiteField) / green};
  }

  // All fields but `left_out` (-1: all).
  Problem problem(int left_out) const {
    Problem out;
    for (int i = 0; i < kChartFields; ++i) {
      if (i == left_out) continue;
      Matrix terms = terms_.row(i).clone(), constant = Matrix::zeros(1, 3);
      if (white_.used) {
        constant = terms(0, kGreen) * white_.of_green;
        terms -= terms(0, kGreen) * white_.share;  // green's own becomes 0
      }
      out.terms.push_back(terms);
      out.constant.push_back(constant);
      out.wanted.push_back(wanted_.row(i));
      out.expected.push_back(expected_[i]);
    }
    return out;
  }

  // Of the terms as they are.
  ColourModel model(const Matrix& solved) const {
    Matrix m = solved.clone();
    if (white_.used) {
      m.row(kGreen) = 0;
      const Matrix green = white_.of_green - white_.share * m;
      green.copyTo(m.row(kGreen));
    }
    ColourModel out{kind_, std::vector<double>(static_cast<std::size_t>(3) * count_)};
    for (int c = 0; c < 3; ++c)
      for (int t = 0; t < count_; ++t) {
        const bool offset = kind_ == FitKind::k4x3 && t == 3;
        out.xyz_from_terms[c * count_ + t] = m(t, c) * (offset ? 1 : scale_);
      }
    return out;
  }

 private:
  FitKind kind_;
  int count_;
  double scale_ = 1;
  Matrix terms_, wanted_;
  std::vector<Lab> expected_;
  WhiteRule white_;
};

// Of a matrix that is positive but for rounding; a trace of its own size holds what the fields
// leave open (green, where white is preserved).
bool solveNormal(Matrix normal, const Matrix& right, double relative, Matrix& solution) {
  const double own = relative * cv::trace(normal)[0];
  for (int i = 0; i < normal.rows; ++i) normal(i, i) += own;
  return cv::solve(normal, right, solution, cv::DECOMP_CHOLESKY);
}

// Relative errors count in XYZ, as they do to the eye.
bool leastSquares(const Problem& problem, Matrix& m) {
  Matrix terms = problem.terms.clone(), wanted = problem.wanted - problem.constant;
  for (int i = 0; i < terms.rows; ++i) {
    const double weight = 1 / (problem.wanted(i, 1) + 0.05);
    terms.row(i) *= weight;
    wanted.row(i) *= weight;
  }
  return solveNormal(terms.t() * terms, terms.t() * wanted, 1e-9, m);
}

Matrix residualsOf(const Problem& problem, const Matrix& m) {
  const Matrix seen = problem.colours(m);
  Matrix out(3 * seen.rows, 1);
  for (int i = 0; i < seen.rows; ++i) {
    const auto parts =
        deltaE2000Parts(problem.expected[i], labOf({seen(i, 0), seen(i, 1), seen(i, 2)}));
    for (int k = 0; k < 3; ++k) out(3 * i + k) = parts[k];
  }
  return out;
}

// By the chain rule: parts by XYZ (by differences), XYZ by the coefficients (the terms). A column
// for each coefficient, in the order of M's rows.
Matrix jacobianOf(const Problem& problem, const Matrix& m) {
  constexpr double kStep = 1e-6;
  const Matrix seen = problem.colours(m);
  const int count = problem.terms.cols;
  Matrix out(3 * seen.rows, 3 * count);
  for (int i = 0; i < seen.rows; ++i)
    for (int c = 0; c < 3; ++c) {
      std::array<double, 3> up{seen(i, 0), seen(i, 1), seen(i, 2)}, down = up;
      up[c] += kStep, down[c] -= kStep;
      const auto above = deltaE2000Parts(problem.expected[i], labOf({up[0], up[1], up[2]}));
      const auto below = deltaE2000Parts(problem.expected[i], labOf({down[0], down[1], down[2]}));
      for (int k = 0; k < 3; ++k)
        for (int t = 0; t < count; ++t)
          out(3 * i + k, 3 * t + c) = (above[k] - below[k]) / (2 * kStep) * problem.terms(i, t);
    }
  return out;
}

double squaresOf(const Matrix& residuals) { return residuals.dot(residuals); }

// Levenberg-Marquardt on the sum of squared deltaE; returns the iterations taken.
int refine(const Problem& problem, int iterations_max, Matrix& m) {
  Matrix residuals = residualsOf(problem, m);
  double cost = squaresOf(residuals), damping = 1e-3;
  for (int iteration = 0; iteration < iterations_max; ++iteration) {
    const Matrix jacobian = jacobianOf(problem, m);
    const Matrix normal = jacobian.t() * jacobian, downhill = -jacobian.t() * residuals;
    double cost_then = cost;
    for (; damping < 1e9; damping *= 8) {
      Matrix damped = normal.clone(), step;
      for (int i = 0; i < damped.rows; ++i) damped(i, i) *= 1 + damping;
      if (!solveNormal(damped, downhill, 1e-12, step)) continue;
      const Matrix next = m + step.reshape(1, m.rows);
      const Matrix then = residualsOf(problem, next);
      cost_then = squaresOf(then);
      if (!(cost_then < cost)) continue;
      m = next;
      residuals = then;
      damping /= 8;
      break;
    }
    if (!(cost_then < cost)) return iteration;
    const bool done = cost - cost_then < 1e-7 * cost;
    cost = cost_then;
    if (done) return iteration + 1;
  }
  return iterations_max;
}

double errorOf(const ColourModel& model, const Rgb& seen, const Lab& expected) {
  return deltaE2000(expected, labOf(colourOf(model, seen)));
}

// What is seen without any calibration: white balance by the white field, sRGB's primaries.
Lab before(const Rgb& seen, const SeenColours& all, const ChartColours& expected) {
  const auto white = mapped(linearSrgbFromXyz(), [&] {
    const Xyz w = xyzOf({expected[kWhiteField].l, 0, 0});
    return std::array<double, 3>{w.x, w.y, w.z};
  }());
  Rgb balanced;
  for (int c = 0; c < 3; ++c) balanced[c] = seen[c] / all[kWhiteField][c] * white[c];
  const auto xyz = mapped(xyzFromLinearSrgb(), balanced);
  return labOf({xyz[0], xyz[1], xyz[2]});
}

void describe(const SeenColours& seen, const ChartColours& expected, ColourFit& fit) {
  ColourFitReport& report = fit.report;
  std::array<double, kChartFields> after{};
  for (int i = 0; i < kChartFields; ++i) {
    FieldColours& field = report.fields[i];
    field.expected = expected[i];
    field.before = before(seen[i], seen, expected);
    field.after = labOf(colourOf(fit.model, seen[i]));
    field.delta_e_before = deltaE2000(expected[i], field.before);
    field.delta_e_after = after[i] = deltaE2000(expected[i], field.after);
    report.mean_before += field.delta_e_before / kChartFields;
    report.mean_after += field.delta_e_after / kChartFields;
    report.worst_before = std::max(report.worst_before, field.delta_e_before);
    if (field.delta_e_after > report.worst_after) {
      report.worst_after = field.delta_e_after;
      report.worst_field = i;
    }
  }
  std::sort(after.begin(), after.end());
  report.median_after = (after[kChartFields / 2 - 1] + after[kChartFields / 2]) / 2;
}

struct Candidate {
  ColourModel model;
  KindError error;
  int iterations = 0;
};

Candidate fitKind(const SeenColours& seen, const ChartColours& expected, FitKind kind,
                  const FitOptions& options, Progress& progress) {
  const Chart chart(seen, expected, kind, options.preserve_white);
  const Problem all = chart.problem(-1);
  Matrix whole;
  if (!leastSquares(all, whole))
    throw CalibrationError(Exit::kBadData, "the fields of the chart do not determine a " +
                                               nameOf(kind) + " fit: are all of them alike?");
  Candidate out;
  out.iterations = refine(all, options.iterations_max, whole);
  out.model = chart.model(whole);
  out.error.kind = kind;
  for (int i = 0; i < kChartFields; ++i)
    out.error.mean += errorOf(out.model, seen[i], expected[i]) / kChartFields;
  // White preserved leans on the white field: it is left out of the fit, never of that rule.
  for (int i = 0; i < kChartFields; ++i) {
    const Problem without = chart.problem(i);
    Matrix m;  // from its own start: the whole's has seen the field
    if (!leastSquares(without, m))
      throw CalibrationError(Exit::kBadData, "without the field " + fieldName(i) +
                                                 " the chart does not determine a " + nameOf(kind) +
                                                 " fit");
    refine(without, std::min(options.iterations_max, kIterationsLeftOut), m);
    out.error.left_out_mean += errorOf(chart.model(m), seen[i], expected[i]) / kChartFields;
    progress.step();
  }
  return out;
}

}  // namespace

void FitOptions::check() const {
  if (iterations_max < 0 || iterations_max > 1000)
    throw CalibrationError(Exit::kUsage, "iterations_max must lie in [0, 1000]");
}

ColourFit fitColour(const SeenColours& seen, const ChartColours& expected,
                    const FitOptions& options, Progress& progress) {
  options.check();
  for (int i = 0; i < kChartFields; ++i) {
    const auto [least, most] = std::ranges::minmax(seen[i]);
    if (!(std::isfinite(least) && std::isfinite(most)) || (i == kWhiteField && !(least > 0)))
      throw CalibrationError(Exit::kBadData,
                             "the chart's field " + fieldName(i) + " has no level to fit");
  }
  std::vector<FitKind> kinds(kFitKinds.begin(), kFitKinds.end());
  if (options.kind) kinds = {*options.kind};
  progress.begin("fitting colours", static_cast<std::int64_t>(kinds.size()) * kChartFields);
  std::vector<Candidate> candidates;
  double least = HUGE_VAL;
  for (const FitKind kind : kinds) {
    candidates.push_back(fitKind(seen, expected, kind, options, progress));
    least = std::min(least, candidates.back().error.left_out_mean);
  }
  ColourFit fit;
  for (const Candidate& candidate : candidates) fit.report.kinds.push_back(candidate.error);
  const auto taken = std::ranges::find_if(candidates, [&](const Candidate& candidate) {
    return candidate.error.left_out_mean <= kAsGood * least;
  });
  fit.model = std::move(taken->model);
  fit.report.left_out_mean = taken->error.left_out_mean;
  fit.report.iterations = taken->iterations;
  describe(seen, expected, fit);
  return fit;
}

}  // namespace patina::calibration
