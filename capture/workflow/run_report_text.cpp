// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <cstdio>
#include <functional>

#include "capture/workflow/run_report.h"

namespace patina::workflow {
namespace {

constexpr std::size_t kEventsShown = 60;

struct CountLine {
  const char* name;
  std::int64_t steps;
  const char* meaning;
};

std::array<CountLine, 6> countLines(const RunReport& r) {
  return {{{"captured", r.captured, "every shot of the step is in the archive"},
           {"held", r.held, "its time passed while the light was bad"},
           {"skipped", r.skipped, "late by more than half an interval, or no disk"},
           {"missed", r.missed, "nobody was running"},
           {"failed", r.failed, "tried, and a device failed"},
           {"partial", r.partial, "of these, some shots but not all are there (kept, flagged)"}}};
}

std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string summary(const RunReport& r) {
  const double share = r.steps_due ? 100.0 * double(r.captured) / double(r.steps_due) : 0;
  std::string text = "Of " + std::to_string(r.steps_due) + " steps, " + std::to_string(r.captured) +
                     " (" + fixed(share, 1) + " %) were captured: " + std::to_string(r.frames) +
                     " frames, " + formatBytes(r.bytes) + ". ";
  if (r.captured_after_hold)
    text += std::to_string(r.captured_after_hold) +
            " of them waited for the light and were then shot. ";
  if (r.retried) text += std::to_string(r.retried) + " needed a second attempt. ";
  if (r.gain_most > 1 || r.gain_least < 1)
    text += "Lamp drift was corrected by gains from " + fixed(r.gain_least, 4) + " to " +
            fixed(r.gain_most, 4) + ", stored beside the frames; no pixel was rewritten. ";
  if (r.pending) text += std::to_string(r.pending) + " step is still open. ";
  return text + "Every step that was due has a row, also those that did not happen.";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

// A reason or an event may hold what a device said: it must not break a table.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|')
      out += "\\|";
    else if (c == '\n' || c == '\r')
      out += ' ';
    else
      out += c;
  }
  return out;
}

bool isFilm(const std::string& path) { return path.ends_with(".mp4"); }

}  // namespace

std::string reportMarkdown(const RunReport& r, const std::vector<ReportPicture>& pictures) {
  std::string out = "# Run " + r.run.id + "\n\n" + summary(r) + "\n\n";
  out += "| steps | count | meaning |\n|---|---:|---|\n";
  for (const CountLine& line : countLines(r))
    out += std::string("| ") + line.name + " | " + std::to_string(line.steps) + " | " +
           line.meaning + " |\n";
  out += "\n## Why steps are not there\n\n";
  if (r.reasons.empty())
    out += "Every due step was captured.\n";
  else
    out += "| decision | steps | reason (an example) |\n|---|---:|---|\n";
  for (const auto& [decision, kinds] : r.reasons)
    for (const ReasonCount& kind : kinds)
      out += "| " + decision + " | " + std::to_string(kind.steps) + " | " + cell(kind.example) +
             " |\n";
  out += "\n## Light\n\n| verdict | checks |\n|---|---:|\n";
  for (const auto& [verdict, rows] : r.light_verdicts)
    out += "| " + verdict + " | " + std::to_string(rows) + " |\n";
  out += "\n## Events\n\n| UTC | event | detail |\n|---|---|---|\n";
  for (std::size_t i = 0; i < r.events.size() && i < kEventsShown; ++i)
    out += "| " + formatUtc(r.events[i].utc) + " | " + cell(r.events[i].kind) + " | " +
           cell(r.events[i].detail) + " |\n";
  if (r.events.size() > kEventsShown)
    out += "\n" + std::to_string(r.events.size() - kEventsShown) +
           " more events: `patina archive show " + r.run.id + "`\n";
  out += "\n## Pictures\n";
  for (const ReportPicture& p : pictures)
    out += isFilm(p.path) ? "\n[" + p.title + "](" + p.path + ")\n"
                          : "\n" + p.title + "\n\n![" + p.title + "](" + p.path + ")\n";
  return out;
}

std::string reportHtml(const RunReport& r, const std::vector<ReportPicture>& pictures) {
  std::string out =
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>" +
      escaped(r.run.id) +
      "</title><style>body{font:16px/1.5 system-ui,sans-serif;max-width:64rem;margin:2rem auto;"
      "padding:0 1rem;color:#222}table{border-collapse:collapse;margin:1rem 0}"
      "td,th{border-bottom:1px solid #ddd;padding:.25rem .75rem;text-align:left;"
      "vertical-align:top}td.n{text-align:right;font-variant-numeric:tabular-nums}"
      "img,video{max-width:100%;display:block;margin:.5rem 0 1.5rem}h1{font-size:1.5rem}"
      "</style><h1>Run " +
      escaped(r.run.id) + "</h1><p>" + escaped(summary(r)) +
      "</p><table><tr><th>steps</th><th>count</th><th>meaning</th></tr>";
  const auto row = [&](const std::string& a, const std::string& n, const std::string& b) {
    out += "<tr><td>" + escaped(a) + "</td><td class=\"n\">" + escaped(n) + "</td><td>" +
           escaped(b) + "</td></tr>";
  };
  for (const CountLine& line : countLines(r))
    row(line.name, std::to_string(line.steps), line.meaning);
  out += "</table>";
  for (const ReportPicture& p : pictures)
    out +=
        "<h2>" + escaped(p.title) + "</h2>" +
        (isFilm(p.path) ? "<video controls loop muted src=\"" + escaped(p.path) + "\"></video>"
                        : "<img alt=\"" + escaped(p.title) + "\" src=\"" + escaped(p.path) + "\">");
  out +=
      "<h2>Why steps are not there</h2><table><tr><th>decision</th><th>steps</th>"
      "<th>reason (an example)</th></tr>";
  for (const auto& [decision, kinds] : r.reasons)
    for (const ReasonCount& kind : kinds) row(decision, std::to_string(kind.steps), kind.example);
  out += "</table><h2>Light</h2><table><tr><th>verdict</th><th>checks</th><th></th></tr>";
  for (const auto& [verdict, rows] : r.light_verdicts) row(verdict, std::to_string(rows), "");
  out += "</table><h2>Events</h2><table><tr><th>UTC</th><th>event</th><th>detail</th></tr>";
  for (std::size_t i = 0; i < r.events.size() && i < kEventsShown; ++i)
    row(formatUtc(r.events[i].utc), r.events[i].kind, r.events[i].detail);
  return out + "</table></html>\n";
}

}  // namespace patina::workflow
