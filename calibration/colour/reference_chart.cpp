// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/reference_chart.h"

#include <cmath>
#include <sstream>
#include <vector>

#include "calibration/failure.h"

namespace patina::calibration {
namespace {

constexpr ChartColours kBefore2014{
    {{37.986, 13.555, 14.059},  {65.711, 18.130, 17.810},  {49.927, -4.880, -21.925},
     {43.139, -13.095, 21.905}, {55.112, 8.844, -25.399},  {70.719, -33.397, -0.199},
     {62.661, 36.067, 57.096},  {40.020, 10.410, -45.964}, {51.124, 48.239, 16.248},
     {30.325, 22.976, -21.587}, {72.532, -23.709, 57.255}, {71.941, 19.363, 67.857},
     {28.778, 14.179, -50.297}, {55.261, -38.342, 31.370}, {42.101, 53.378, 28.190},
     {81.733, 4.039, 79.819},   {51.935, 49.986, -14.574}, {51.038, -28.631, -28.638},
     {96.539, -0.425, 1.186},   {81.257, -0.638, -0.335},  {66.766, -0.734, -0.504},
     {50.867, -0.153, -0.270},  {35.656, -0.421, -1.231},  {20.461, -0.079, -0.973}}};

constexpr ChartColours kSince2014{
    {{37.54, 14.37, 14.92},  {64.66, 19.27, 17.50},  {49.32, -3.82, -22.54},
     {43.46, -12.74, 22.72}, {54.94, 9.61, -24.79},  {70.48, -32.26, -0.37},
     {62.73, 35.83, 56.50},  {39.43, 10.75, -45.17}, {50.57, 48.64, 16.67},
     {30.10, 22.54, -20.87}, {71.77, -24.13, 58.19}, {71.51, 18.24, 67.37},
     {28.37, 15.42, -49.80}, {54.38, -39.72, 32.27}, {42.43, 51.05, 28.62},
     {81.80, 2.67, 80.41},   {50.63, 51.28, -14.12}, {49.57, -29.71, -28.32},
     {95.19, -1.03, 2.93},   {81.29, -0.57, 0.44},   {66.89, -0.75, -0.06},
     {50.76, -0.13, 0.14},   {35.63, -0.46, -0.48},  {20.64, 0.07, -0.46}}};

// The last three numbers of a line; none when it has fewer, which is a heading.
std::vector<double> lastThree(std::string line) {
  for (char& c : line)
    if (c == ',' || c == ';' || c == '\t') c = ' ';
  std::istringstream words(line);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    std::size_t used = 0;
    double value = 0;
    try {
      value = std::stod(word, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used == word.size() && std::isfinite(value)) numbers.push_back(value);
  }
  if (numbers.size() < 3) return {};
  return {numbers.end() - 3, numbers.end()};
}

}  // namespace

const ChartColours& chartColours(ChartEdition edition) {
  return edition == ChartEdition::kBefore2014 ? kBefore2014 : kSince2014;
}

ChartColours parseChartColours(const std::string& text) {
  ChartColours out;
  int fields = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#')) continue;
    const std::vector<double> numbers = lastThree(line);
    if (numbers.empty()) continue;
    if (numbers[0] < 0 || numbers[0] > 100 || std::hypot(numbers[1], numbers[2]) > 200)
      throw CalibrationError(Exit::kBadData, "'" + line + "' is no colour L a b (L from 0 to 100)");
    if (fields < kChartFields) out[fields] = {numbers[0], numbers[1], numbers[2]};
    ++fields;
  }
  if (fields != kChartFields)
    throw CalibrationError(Exit::kBadData,
                           "the chart's values have " + std::to_string(fields) +
                               " fields instead of 24: one line L a b a field, from dark skin to "
                               "black, row by row");
  return out;
}

const std::string& fieldName(int field) {
  static const std::array<std::string, kChartFields> names{
      "dark skin", "light skin",    "blue sky",     "foliage",   "blue flower",  "bluish green",
      "orange",    "purplish blue", "moderate red", "purple",    "yellow green", "orange yellow",
      "blue",      "green",         "red",          "yellow",    "magenta",      "cyan",
      "white",     "neutral 8",     "neutral 6.5",  "neutral 5", "neutral 3.5",  "black"};
  return names.at(static_cast<std::size_t>(field));
}

}  // namespace patina::calibration
