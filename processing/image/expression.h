// SPDX-License-Identifier: GPL-3.0-or-later
// Formulas a person types, such as "0.2 + 0.8*slope" or "atan2(y,x)+t": numbers, variables,
// + - * / ^, comparisons, cond ? a : b, sin cos tan asin acos atan atan2 exp ln log10 sqrt abs min
// max sum avg rint sign, and pi.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "processing/image/image.h"

namespace patina {

class Expression {
 public:
  // Throws ProcessingError(kUsage) with the place and what is wrong; an unknown variable with the
  // known ones.
  Expression(const std::string& text, const std::vector<std::string>& variables);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;

  const std::set<std::string>& used() const { return used_; }  // of the variables
  // `values` in the order of the variables. Not thread-safe. NaN and infinities come out as such.
  double at(const std::vector<double>& values);

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  std::set<std::string> used_;
};

}  // namespace patina
