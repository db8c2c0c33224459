// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/light_report.h"

#include <algorithm>
#include <cmath>
#include <set>
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
  if (check.verdict == "learn" || check.verdict == "pass" || check.verdict == "correct") {
    series.taken.utc.push_back(check.utc);
    series.taken.level.push_back(check.level);
    series.taken.baseline.push_back(check.baseline);
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
      // That one witness is well does not end what another suffers.
      if (open != open_.end() && open->second.sources.contains(check.source)) close(open);
      return;
    }
    Open& spell = open_[check.light_state];
    if (spell.bad.checks++ == 0) {
      spell.bad.light = check.light_state;
      spell.bad.from = check.utc;
    }
    spell.bad.to = check.utc;
    spell.bad.content = spell.bad.content || check.source.starts_with("content:");
    if (check.baseline > 0) spell.bad.ratio_worst = furthest(spell.bad.ratio_worst, check.ratio);
    ++spell.verdicts[check.verdict];
    spell.sources.insert(check.source);
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
    std::set<std::string> sources;
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

constexpr std::size_t kNamedMost = 5;  // steps or spells named in a sentence
constexpr double kWarmUpTold = 0.002;  // missing share worth a word
constexpr double kColourTold = 0.001;  // du'v'
constexpr double kBadMost = 0.2;       // share of the checks of a run that is trusted

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
  if (spell.verdict == "at_odds" && spell.content)
    return "The picture under " + spell.light + " changed in part and the patch did not " + when +
           ": a shadow or a visitor?";
  if (spell.verdict == "at_odds")
    return "Patch and sensor disagreed about " + spell.light + " " + when + ".";
  if (spell.ratio_worst < 0.05) return spell.light + " was out " + when + ".";
  return spell.light + " was at " + level + " " + when + ": " +
         (spell.verdict == "fail" ? "refused." : "held.");
}

std::string toldOf(const ToldStep& told) {
  std::string text = told.step == 0 ? std::string("flicker from ") : percent(told.step) + " at ";
  text += minuteOf(told.utc);
  return text;
}

void sayCharts(const LightReport& report, std::vector<std::string>& say) {
  for (const LightSeriesReport& one : report.series) {
    const std::string who = one.light + " (" + one.source + " " + one.channel + ")";
    std::string when;
    std::size_t named = 0;
    for (const ToldStep& told : one.charts.told)
      if (++named <= kNamedMost) when.append(when.empty() ? "" : ", ").append(toldOf(told));
    if (named > kNamedMost) when += " and " + std::to_string(named - kNamedMost) + " more";
    if (named > 0)
      say.push_back(std::string(who).append(" changed at once, not by drift: ").append(when) + ".");
    const calibration::WarmUp& warm = one.charts.warm_up;
    if (warm.found && std::abs(warm.missing) > kWarmUpTold &&
        (one.channel == "g" || one.channel == "y")) {
      const double minutes = toSeconds(warm.waitFor(kWarmUpTold)) / 60;
      char text[160];
      std::snprintf(text, sizeof text,
                    " warms up by %.1f %% with a time constant of %.1f min: wait %.0f min.",
                    100 * warm.missing, toSeconds(warm.tau) / 60, std::ceil(minutes));
      say.push_back(who + text);
    }
    for (const auto& [quantity, fit] : one.charts.follows) {
      if (one.channel != "g" && one.channel != "y") continue;
      if (!(std::abs(fit.slope) > 4 * fit.slope_error) || std::abs(fit.correlation) < 0.3) continue;
      char text[120];
      std::snprintf(text, sizeof text, " follows the %s: %+.3f %% a %s (correlation %.2f).",
                    quantity.c_str(), 100 * fit.slope,
                    quantity == "humidity" ? "percent" : "kelvin", fit.correlation);
      say.push_back(who + text);
    }
  }
  for (const ColourChart& colour : report.colours) {
    if (colour.du_v_max < kColourTold) continue;
    char text[80];
    std::snprintf(text, sizeof text, " went as far as du'v' %.4f from its colour.",
                  colour.du_v_max);
    say.push_back(colour.light + " (" + colour.source + ")" + text);
  }
  for (const auto& [lamp, use] : report.lamps) {
    char text[96];
    std::snprintf(text, sizeof text, ": %lld shots, %.2f hours lit.",
                  static_cast<long long>(use.shots), use.hours);
    say.push_back("Lamp " + lamp + text);
  }
}

// Whether the frames of this run may be compared with one another, and where not.
void judgeRun(LightReport& report) {
  std::int64_t bad = 0, controlled = 0;
  for (const auto& [verdict, count] : report.verdicts) {
    if (verdict != "measure") controlled += count;
    if (!isGoodVerdict(verdict)) bad += count;
  }
  std::string text;
  if (controlled == 0) {
    report.verdict =
        "Nobody watched the light of this run: `patina light measure` may tell its gain "
        "from a region that does not change.";
    return;
  }
  std::size_t told = 0;
  for (const LightSeriesReport& one : report.series) told = std::max(told, one.charts.told.size());
  const double share = static_cast<double>(bad) / static_cast<double>(controlled);
  report.trusted = share < kBadMost;
  if (!report.trusted)
    text = "The light of this run cannot be trusted as a whole: " + percent(share) +
           " of its checks were refused or at odds";
  else if (report.spells.empty() && told == 0)
    text = "The light of this run can be trusted throughout";
  else
    text = "The light of this run can be trusted";
  if (!report.spells.empty()) {
    text += report.trusted ? ", except " : ": ";
    for (std::size_t i = 0; i < report.spells.size() && i < kNamedMost; ++i)
      text += (i > 0 ? ", " : "") + report.spells[i].light + " from " +
              minuteOf(report.spells[i].from) + " to " + minuteOf(report.spells[i].to);
    if (report.spells.size() > kNamedMost)
      text += " and " + std::to_string(report.spells.size() - kNamedMost) + " times more";
  }
  if (told > 0)
    text +=
        "; where a lamp changed at once its gain follows, its colour and place may not have "
        "stayed";
  report.verdict = text + ".";
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
  sayCharts(report, say);
  for (const BadSpell& spell : report.spells) say.push_back(spellSentence(spell));
  if (report.spells.empty()) say.push_back("The light was never out of its band.");
  say.push_back(report.verdict);
  if (report.held > Nanoseconds{}) {
    const auto minutes = std::chrono::duration_cast<std::chrono::minutes>(report.held).count();
    say.push_back(std::to_string(report.steps_held) + " steps waited for light, " +
                  std::to_string(minutes) + " minutes in all.");
  }
}

}  // namespace

bool isLevel(const LightSeriesReport& series) { return !series.source.starts_with("content:"); }

bool isGoodVerdict(const std::string& verdict) {
  return verdict == "learn" || verdict == "pass" || verdict == "correct" || verdict == "measure";
}

LightReport reportLight(const db::ArchiveReader& reader, const std::string& run_id,
                        const std::vector<std::string>& stay_on) {
  LightReport report;
  const db::RunRow run = reader.findRun(run_id);
  report.run_id = run.id;
  report.t0_utc = run.t0_utc;
  std::map<SeriesKey, LightSeriesReport> series;
  Spells spells;
  const std::vector<db::LightCheckRow> checks = reader.lightChecks(run.id);
  const std::vector<db::ReadingRow> readings = reader.readings(run.id);
  for (const db::LightCheckRow& check : checks) {
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
  for (auto& [key, one] : series) {
    if (isLevel(one)) one.charts = chartSeries(one.taken, run.t0_utc, readings);
    report.series.push_back(std::move(one));
  }
  report.colours = chartColours(checks, run.t0_utc);
  report.lamps = lampUse(reader, run.id, stay_on);
  report.sweep_spread = sweepSpread(checks);
  report.spells = spells.finish();
  for (const db::StepRow& step : reader.steps(run.id)) {
    report.held += step.held;
    report.steps_held += step.held > Nanoseconds{};
    report.sweep_spread_time = std::max(report.sweep_spread_time, step.spread);
  }
  judgeRun(report);
  writeSentences(report);
  return report;
}

}  // namespace patina::workflow
