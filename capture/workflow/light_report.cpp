// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/light_report.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace patina::workflow {
namespace {

using SeriesKey = std::tuple<std::string, int, std::string, std::string>;

double furthest(double a, double b) { return std::abs(a - 1) >= std::abs(b - 1) ? a : b; }

void take(LightSeriesReport& series, const db::LightCheckRow& check, UtcTime t0) {
  ++series.checks;
  ++series.verdicts[check.verdict];
  if (check.verdict == "correct") {
    series.gain_min = std::min(series.gain_min, check.gain);
    series.gain_max = std::max(series.gain_max, check.gain);
  }
  if (!(check.baseline > 0)) return;
  series.ratio_min = std::min(series.ratio_min, check.ratio);
  series.ratio_max = std::max(series.ratio_max, check.ratio);
  series.time_s.push_back(toSeconds(check.utc - t0));
  series.ratio.push_back(check.ratio);
  series.verdict.push_back(check.verdict);
}

// Checks that are not good belong to one spell until a good one of the same light comes between.
class Spells {
 public:
  void take(const db::LightCheckRow& check) {
    if (check.light_state == "off") return;
    const auto open = open_.find(check.light_state);
    if (isGoodVerdict(check.verdict)) {
      if (open != open_.end()) close(open);
      return;
    }
    Open& spell = open_[check.light_state];
    if (spell.bad.checks++ == 0) {
      spell.bad.light = check.light_state;
      spell.bad.from = check.utc;
    }
    spell.bad.to = check.utc;
    if (check.baseline > 0) spell.bad.ratio_worst = furthest(spell.bad.ratio_worst, check.ratio);
    ++spell.verdicts[check.verdict];
  }
  std::vector<BadSpell> finish() {
    while (!open_.empty()) close(open_.begin());
    std::sort(done_.begin(), done_.end(),
              [](const BadSpell& a, const BadSpell& b) { return a.from < b.from; });
    return std::move(done_);
  }

 private:
  struct Open {
    BadSpell bad;
    std::map<std::string, std::int64_t> verdicts;
  };
  void close(std::map<std::string, Open>::iterator open) {
    Open& spell = open->second;
    spell.bad.verdict =
        std::max_element(spell.verdicts.begin(), spell.verdicts.end(), [](auto& a, auto& b) {
          return a.second < b.second;
        })->first;
    done_.push_back(std::move(spell.bad));
    open_.erase(open);
  }
  std::map<std::string, Open> open_;
  std::vector<BadSpell> done_;
};

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, std::abs(share) < 0.1 ? "%.1f %%" : "%.0f %%", 100 * share);
  return text;
}

std::string minuteOf(UtcTime t) { return formatUtc(t).substr(0, 16); }

std::string spellSentence(const BadSpell& spell) {
  const std::string when = spell.from == spell.to
                               ? "at " + minuteOf(spell.from)
                               : "from " + minuteOf(spell.from) + " to " + minuteOf(spell.to);
  const std::string level = percent(spell.ratio_worst) + " of its baseline";
  if (spell.verdict == "saturated") return spell.light + " clipped its patch " + when + ".";
  if (spell.verdict == "covered")
    return "The patch was covered under " + spell.light + " " + when + ".";
  if (spell.verdict == "at_odds")
    return "Patch and sensor disagreed about " + spell.light + " " + when + ".";
  if (spell.ratio_worst < 0.05) return spell.light + " was out " + when + ".";
  return spell.light + " was at " + level + " " + when + ": " +
         (spell.verdict == "fail" ? "refused." : "held.");
}

void writeSentences(LightReport& report) {
  std::vector<std::string>& say = report.sentences;
  if (report.checks == 0) {
    say.push_back("This run has no light checks.");
    return;
  }
  std::string counts;
  for (const auto& [verdict, count] : report.verdicts)
    counts += (counts.empty() ? "" : ", ") + std::to_string(count) + " " + verdict;
  say.push_back(std::to_string(report.checks) + " light checks: " + counts + ".");
  for (const LightSeriesReport& one : report.series) {
    const auto corrected = one.verdicts.find("correct");
    if (corrected == one.verdicts.end()) continue;
    say.push_back(one.light + " (" + one.source + " " + one.channel + ") was corrected in " +
                  std::to_string(corrected->second) + " of " + std::to_string(one.checks) +
                  " checks, by " + percent(one.gain_min - 1) + " to " + percent(one.gain_max - 1) +
                  ".");
  }
  for (const BadSpell& spell : report.spells) say.push_back(spellSentence(spell));
  if (report.spells.empty()) say.push_back("The light was never out of its band.");
  if (report.held > Nanoseconds{}) {
    const auto minutes = std::chrono::duration_cast<std::chrono::minutes>(report.held).count();
    say.push_back(std::to_string(report.steps_held) + " steps waited for light, " +
                  std::to_string(minutes) + " minutes in all.");
  }
}

}  // namespace

bool isGoodVerdict(const std::string& verdict) {
  return verdict == "learn" || verdict == "pass" || verdict == "correct" || verdict == "measure";
}

LightReport reportLight(const db::ArchiveReader& reader, const std::string& run_id) {
  LightReport report;
  const db::RunRow run = reader.findRun(run_id);
  report.run_id = run.id;
  report.t0_utc = run.t0_utc;
  std::map<SeriesKey, LightSeriesReport> series;
  Spells spells;
  for (const db::LightCheckRow& check : reader.lightChecks(run.id)) {
    LightSeriesReport& one =
        series[{check.light_state, check.exposure_index, check.source, check.channel}];
    if (one.checks == 0) {
      one.light = check.light_state;
      one.source = check.source;
      one.channel = check.channel;
      one.exposure = check.exposure_index;
    }
    take(one, check, run.t0_utc);
    spells.take(check);
    ++report.verdicts[check.verdict];
    ++report.checks;
  }
  for (auto& [key, one] : series) report.series.push_back(std::move(one));
  report.spells = spells.finish();
  for (const db::StepRow& step : reader.steps(run.id)) {
    report.held += step.held;
    report.steps_held += step.held > Nanoseconds{};
  }
  writeSentences(report);
  return report;
}

}  // namespace patina::workflow
