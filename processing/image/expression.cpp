// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/expression.h"

#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace patina {

struct Expression::Parser {
  mu::Parser parser;
  std::vector<double> values;
};

Expression::Expression(const std::string& text, const std::vector<std::string>& variables)
    : parser_(std::make_unique<Parser>()) {
  parser_->values.resize(variables.size());
  std::string known;
  for (const std::string& name : variables) known += (known.empty() ? "" : ", ") + name;
  try {
    mu::Parser& parser = parser_->parser;
    parser.ClearConst();  // its own have twelve digits
    parser.DefineConst("pi", std::numbers::pi);
    parser.DefineFun("atan2", [](double y, double x) { return std::atan2(y, x); });
    parser.SetExpr(text);
    for (const auto& [name, unused] : parser.GetUsedVar()) {
      if (std::find(variables.begin(), variables.end(), name) == variables.end())
        throw ProcessingError(Exit::kUsage,
                              "'" + text + "': there is no '" + name + "'; variables are " + known);
      used_.insert(name);
    }
    for (std::size_t i = 0; i < variables.size(); ++i)
      parser.DefineVar(variables[i], &parser_->values[i]);
    parser.Eval();
  } catch (const mu::ParserError& error) {
    throw ProcessingError(Exit::kUsage, "'" + text + "': " + error.GetMsg());
  }
}

Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;

double Expression::at(const std::vector<double>& values) {
  PATINA_CHECK(values.size() == parser_->values.size());
  std::copy(values.begin(), values.end(), parser_->values.begin());
  return parser_->parser.Eval();
}

}  // namespace patina
