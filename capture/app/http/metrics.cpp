// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/metrics.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "processing/image/failure.h"

namespace patina::http {
namespace {

constexpr std::size_t kSeriesMax = 256;

const char* kindName(MetricKind kind) {
  switch (kind) {
    case MetricKind::kCounter:
      return "counter";
    case MetricKind::kGauge:
      return "gauge";
    case MetricKind::kHistogram:
      return "histogram";
  }
  return "untyped";
}

std::string numberText(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "+Inf" : "-Inf";
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

std::string escaped(const std::string& value) {
  std::string text;
  for (const char c : value) {
    if (c == '\\' || c == '"') text += '\\';
    text += c == '\n' ? "\\n" : std::string(1, c);
  }
  return text;
}

}  // namespace

struct Metrics::Family {
  const MetricFamily& about;
  // Nodes of a map do not move, which keeps the references good.
  std::map<std::vector<std::string>, Counter> counters;
  std::map<std::vector<std::string>, Gauge> gauges;
  std::map<std::vector<std::string>, std::unique_ptr<Histogram>> histograms;

  template <class Map>
  std::vector<std::string> keyIn(const Map& map, const std::vector<std::string>& values) const {
    if (map.contains(values) || map.size() < kSeriesMax) return values;
    return std::vector<std::string>(values.size(), "other");
  }

  std::string labels(const std::vector<std::string>& values, const std::string& bound = {}) const {
    std::string text;
    for (std::size_t i = 0; i < values.size(); ++i)
      text += (text.empty() ? "" : ",") + about.labels[i] + "=\"" + escaped(values[i]) + "\"";
    if (!bound.empty()) text += (text.empty() ? "le=\"" : ",le=\"") + bound + "\"";
    return text.empty() ? text : "{" + text + "}";
  }

  std::string histogramText(const std::vector<std::string>& values, const Histogram& one) const {
    const Histogram::Snapshot now = one.snapshot();
    std::string text;
    for (std::size_t i = 0; i < now.up_to.size(); ++i) {
      const std::string bound = i < about.bounds.size() ? numberText(about.bounds[i]) : "+Inf";
      text +=
          about.name + "_bucket" + labels(values, bound) + " " + numberText(now.up_to[i]) + "\n";
    }
    text += about.name + "_sum" + labels(values) + " " + numberText(now.sum) + "\n";
    return text + about.name + "_count" + labels(values) + " " + numberText(now.up_to.back()) +
           "\n";
  }

  std::string text() const {
    std::string text = "# HELP " + about.name + " " + about.help + "\n# TYPE " + about.name + " " +
                       kindName(about.kind) + "\n";
    const std::size_t head = text.size();
    for (const auto& [values, one] : counters)
      text += about.name + labels(values) + " " + numberText(one.value()) + "\n";
    for (const auto& [values, one] : gauges)
      text += about.name + labels(values) + " " + numberText(one.value()) + "\n";
    for (const auto& [values, one] : histograms) text += histogramText(values, *one);
    return text.size() == head ? std::string() : text;
  }
};

Histogram::Histogram(const std::vector<double>& bounds)
    : bounds_(bounds), counts_(bounds.size() + 1) {}

void Histogram::observe(double value) {
  const auto bucket = std::lower_bound(bounds_.begin(), bounds_.end(), value) - bounds_.begin();
  counts_[static_cast<std::size_t>(bucket)] += 1;
  sum_ += value;
}

Histogram::Snapshot Histogram::snapshot() const {
  Snapshot now{{}, sum_};
  double all = 0;
  for (const auto& count : counts_) now.up_to.push_back(all += count);
  return now;
}

Metrics::Metrics() {
  for (const MetricFamily& family : metricFamilies())
    families_.emplace(family.name, std::make_shared<Family>(Family{family, {}, {}, {}}));
}

Metrics::Family& Metrics::find(const std::string& name, MetricKind kind, std::size_t labels) {
  const auto found = families_.find(name);
  PATINA_CHECK(found != families_.end());
  PATINA_CHECK(found->second->about.kind == kind && found->second->about.labels.size() == labels);
  return *found->second;
}

Counter& Metrics::counter(const std::string& name, const std::vector<std::string>& values) {
  const std::lock_guard lock(mutex_);
  Family& family = find(name, MetricKind::kCounter, values.size());
  return family.counters[family.keyIn(family.counters, values)];
}

Gauge& Metrics::gauge(const std::string& name, const std::vector<std::string>& values) {
  const std::lock_guard lock(mutex_);
  Family& family = find(name, MetricKind::kGauge, values.size());
  return family.gauges[family.keyIn(family.gauges, values)];
}

Histogram& Metrics::histogram(const std::string& name, const std::vector<std::string>& values) {
  const std::lock_guard lock(mutex_);
  Family& family = find(name, MetricKind::kHistogram, values.size());
  auto& one = family.histograms[family.keyIn(family.histograms, values)];
  if (!one) one = std::make_unique<Histogram>(family.about.bounds);
  return *one;
}

void Metrics::beforeText(std::function<void(Metrics&)> collect) {
  const std::lock_guard lock(collect_mutex_);
  collectors_.push_back(std::move(collect));
}

std::string Metrics::text() {
  {
    const std::lock_guard lock(collect_mutex_);
    for (const auto& collect : collectors_) collect(*this);
  }
  std::string text;
  for (const auto& [name, family] : families_) {
    // Not over all of them: capture counts too, and a scrape is written at the lowest priority.
    const std::lock_guard lock(mutex_);
    text += family->text();
  }
  return text;
}

}  // namespace patina::http
