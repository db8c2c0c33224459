// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "capture/app/http/metrics.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina::http {
namespace {

constexpr const char* kNameBytes = "abcdefghijklmnopqrstuvwxyz_";

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
  std::set<std::string> seen;
  for (const MetricFamily& family : metricFamilies()) {
    EXPECT_TRUE(family.name.starts_with("patina_") || family.name.starts_with("process_"));
    EXPECT_EQ(family.name.find_first_not_of(kNameBytes), std::string::npos) << family.name;
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
  int found = 0;
  for (std::size_t at = rules.find("patina_"); at != std::string::npos;
       at = rules.find("patina_", at + 1), ++found) {
    const std::string name = rules.substr(at, rules.find_first_not_of(kNameBytes, at) - at);
    EXPECT_TRUE(exported.contains(name)) << name;
  }
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
