// SPDX-License-Identifier: GPL-3.0-or-later
// Counters, gauges and histograms, and their text for Prometheus. Every name the daemon exports
// stands in metricFamilies(); the alert rules are tested against it.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace patina::http {

enum class MetricKind { kCounter, kGauge, kHistogram };

struct MetricFamily {
  std::string name, help;
  MetricKind kind;
  std::vector<std::string> labels;
  std::vector<double> bounds;  // of a histogram: upper bounds of its buckets, rising
};
const std::vector<MetricFamily>& metricFamilies();

// Updates are atomic and take no lock: a capture thread may call them.
class Counter {
 public:
  void add(double n = 1) { value_ += n; }  // n >= 0
  double value() const { return value_; }

 private:
  std::atomic<double> value_{0};
};

class Gauge {
 public:
  void set(double value) { value_ = value; }
  double value() const { return value_; }

 private:
  std::atomic<double> value_{0};
};

class Histogram {
 public:
  explicit Histogram(const std::vector<double>& bounds);
  void observe(double value);
  struct Snapshot {
    std::vector<double> up_to;  // how many lay at or below each bound, then all
    double sum;
  };
  Snapshot snapshot() const;

 private:
  const std::vector<double>& bounds_;
  std::vector<std::atomic<double>> counts_;  // the last: above every bound
  std::atomic<double> sum_{0};
};

// Thread-safe. References stay good as long as the registry; finding one takes a lock, so whoever
// updates often keeps it.
class Metrics {
 public:
  Metrics();
  // Values in the order of the family's labels. A name, kind or number of labels that no family has
  // is our bug. After 256 series of a family, new ones share one whose values are "other".
  Counter& counter(const std::string& name, const std::vector<std::string>& values = {});
  Gauge& gauge(const std::string& name, const std::vector<std::string>& values = {});
  Histogram& histogram(const std::string& name, const std::vector<std::string>& values = {});

  // Called before each text(), to set what is cheaper to ask for than to keep. Not from within one.
  void beforeText(std::function<void(Metrics&)> collect);
  // The text format 0.0.4. Series nobody has asked for are absent.
  std::string text();

 private:
  struct Family;
  Family& find(const std::string& name, MetricKind kind, std::size_t labels);
  std::mutex mutex_, collect_mutex_;
  std::map<std::string, std::shared_ptr<Family>> families_;
  std::vector<std::function<void(Metrics&)>> collectors_;
};

// process_*: memory, descriptors, CPU and start, from /proc/self.
void collectProcess(Metrics& metrics);

}  // namespace patina::http
