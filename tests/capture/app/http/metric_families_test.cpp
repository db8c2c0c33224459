// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <set>

#include "capture/app/http/metrics.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina::http {
namespace {

std::set<std::string> exportedSeries() {
  std::set<std::string> names;
  for (const MetricFamily& family : metricFamilies()) {
    if (family.kind != MetricKind::kHistogram) names.insert(family.name);
    if (family.kind == MetricKind::kHistogram)
      for (const char* suffix : {"_bucket", "_sum", "_count"}) names.insert(family.name + suffix);
  }
  return names;
}

TEST(MetricFamilies, HaveNamesThatPrometheusTakesAndUnitsInThem) {
  const std::regex name("(patina|process)_[a-z_]+");
  std::set<std::string> seen;
  for (const MetricFamily& family : metricFamilies()) {
    EXPECT_TRUE(std::regex_match(family.name, name)) << family.name;
    EXPECT_TRUE(seen.insert(family.name).second) << family.name;
    EXPECT_EQ(family.kind == MetricKind::kCounter, family.name.ends_with("_total")) << family.name;
    EXPECT_EQ(family.kind == MetricKind::kHistogram, !family.bounds.empty()) << family.name;
    EXPECT_TRUE(std::is_sorted(family.bounds.begin(), family.bounds.end()));
  }
}

TEST(AlertRules, AskOnlyForSeriesThatTheDaemonExports) {
  const std::string rules =
      testing::readFile(testing::sourceFolder() / "packaging/prometheus/patina.rules.yml");
  const auto exported = exportedSeries();
  const std::regex name("\\b(patina|process)_[a-z_]+\\b");
  int found = 0;
  for (std::sregex_iterator it(rules.begin(), rules.end(), name), end; it != end; ++it, ++found)
    EXPECT_TRUE(exported.contains(it->str())) << it->str();
  EXPECT_GT(found, 6);
}

TEST(AlertRules, FireAndKeepSilentAsTheirOwnTestsSay) {
  if (std::system("command -v promtool >/dev/null") != 0)
    GTEST_SKIP() << "no promtool: install prometheus";
  const auto tests = testing::sourceFolder() / "packaging/prometheus/patina.rules.test.yml";
  EXPECT_EQ(std::system(("promtool test rules '" + tests.string() + "' >&2").c_str()), 0);
}

}  // namespace
}  // namespace patina::http
