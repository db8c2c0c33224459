// SPDX-License-Identifier: GPL-3.0-or-later
// patina run watch: the runs as they go; a live screen on a terminal, a line a change elsewhere.
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "capture/app/context.h"
#include "capture/app/daemon/json_rows.h"
#include "capture/app/daemon/places.h"
#include "capture/app/daemon/watch_lines.h"
#include "capture/app/http/client.h"
#include "capture/app/verbs/run_verbs.h"

namespace patina::app {
namespace {

int terminalColumns() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

class Screen {
 public:
  explicit Screen(bool live) : live_(live) {}

  // False: the reader has gone away.
  bool line(const std::string& text) const {
    return std::fprintf(stdout, "%s\n", text.c_str()) >= 0 && std::fflush(stdout) == 0;
  }
  // Over the last one, in one write: no flicker.
  bool draw(const daemon::WatchLines& lines) {
    if (!live_) return true;
    std::string text;
    if (drawn_ > 0) text += "\x1b[" + std::to_string(drawn_) + "A\r\x1b[J";
    const auto shown = lines.screen(terminalColumns());
    for (const std::string& one : shown) text += one + "\n";
    drawn_ = shown.size();
    return std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  }
  bool live() const { return live_; }

 private:
  bool live_;
  std::size_t drawn_ = 0;
};

class Watch {
 public:
  Watch(Context& context, const std::string& run)
      : context_(context),
        run_(run),
        json_(context.options.json),
        screen_(!json_ && isatty(STDOUT_FILENO) == 1),
        lines_(run.empty() ? "" : idOf(now())) {}

  void run() {
    struct Release {
      Signals& signals;
      ~Release() { signals.onStop({}); }
    } release{context_.signals};
    context_.signals.onStop([this] { stop_.request_stop(); });
    http::Client client(daemon::placesToCall(context_.archive()).socket);
    // An id that no daemon gave: it answers with "reset", which says that the stream stands. What
    // is asked for from then on leaves no gap.
    client.events([this](const http::Event& event) { take(event); }, stop_.get_token(), "none");
    if (!stop_.stop_requested()) throw AppError(Exit::kUnavailable, "the daemon has ended");
  }

 private:
  static std::string idOf(const std::vector<daemon::RunView>& runs) {
    return runs.empty() ? "" : runs.front().id;
  }
  std::vector<daemon::RunView> now() const {
    if (run_.empty()) return runsOfDaemon(context_);
    return daemon::runsOf(callDaemon(context_, "GET", "/api/v1/runs/" + run_));
  }

  void take(const http::Event& event) {
    bool heard = true;
    if (event.name == "reset") {
      for (const std::string& line : lines_.take(now()))
        if (!json_ && !screen_.live()) heard = heard && screen_.line(line);
    }
    const std::string change = lines_.take(event.name, event.data);
    if (json_)
      heard = screen_.line("{\"event\":\"" + event.name +
                           "\",\"data\":" + (event.data.empty() ? "null" : event.data) + "}");
    else if (screen_.live())
      heard = screen_.draw(lines_);
    else if (!change.empty())
      heard = screen_.line(change);
    if (!heard || lines_.over()) stop_.request_stop();
  }

  Context& context_;
  const std::string run_;
  const bool json_;
  Screen screen_;
  daemon::WatchLines lines_;
  std::stop_source stop_;
};

void watch(Context& context, const std::string& run) {
  Watch watching(context, run);
  context.answered = true;
  watching.run();
}

}  // namespace

void addRunWatchVerb(Verb& group) {
  auto run = std::make_shared<std::string>();
  group
      .verb("watch",
            "Shows the runs as they go: a line per camera, light, next step, disk; a line a "
            "change when it is not a terminal; with --json each event as it comes",
            "patina run watch --archive banana", [run](Context& context) { watch(context, *run); })
      .optional("RUN", *run, "One run alone, until it ends");
}

}  // namespace patina::app
