// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <utility>

#include "devices/light_settings.h"
#include "devices/serial/escapes.h"
#include "devices/serial/line_output.h"
#include "devices/serial/serial.h"

namespace patina::devices::serial {
namespace {

using namespace std::chrono_literals;

struct Commands {
  std::string on, off, on_reply, off_reply, ask, ask_on, ask_off;
  int levels = 100;
  Nanoseconds timeout{};
};

Commands takeCommands(Settings& settings, bool needed) {
  Commands c;
  c.on = takeBytes(settings, "on");
  c.off = takeBytes(settings, "off");
  c.on_reply = takeBytes(settings, "on_reply");
  c.off_reply = takeBytes(settings, "off_reply");
  c.ask = takeBytes(settings, "ask");
  c.ask_on = takeBytes(settings, "ask_on");
  c.ask_off = takeBytes(settings, "ask_off");
  c.levels = settings.takeInteger("levels", 1, 65535, 100);
  c.timeout = settings.takeDuration("timeout", 10ms, 10s, 1s);
  if (needed == (c.on.empty() || c.off.empty())) settings.reject("on", "give on and off, or line");
  if (c.on_reply.empty() != c.off_reply.empty())
    settings.reject("on_reply", "on_reply and off_reply belong together");
  if (c.ask.empty() ? !(c.ask_on.empty() && c.ask_off.empty())
                    : c.ask_on.empty() || c.ask_off.empty() || c.ask_on == c.ask_off)
    settings.reject("ask", "needs ask_on and ask_off, two different texts");
  return c;
}

// A lamp that is told by commands, or by a control line when `line` is there.
class SerialLight final : public Light {
 public:
  SerialLight(LightCaps caps, Commands commands, std::optional<LineOutput> line,
              std::shared_ptr<Port> port, Clock& clock)
      : caps_(std::move(caps)),
        commands_(std::move(commands)),
        line_(line),
        port_(std::move(port)),
        clock_(clock),
        who_("serial '" + caps_.id + "'") {
    caps_.confirms = !line_ && !(commands_.on_reply.empty() && commands_.ask.empty());
  }
  ~SerialLight() override { static_cast<void>(tell(0)); }

  const LightCaps& caps() const override { return caps_; }
  Result<void> set(double level) override {
    if (auto good = checkLevel(level, who_); !good) return good;
    return named("set", tell(level));
  }
  Result<std::optional<bool>> isOn() override {
    if (commands_.ask.empty() || line_) return acknowledged_;
    const auto line = port_->ask(commands_.ask, "", deadline());
    if (!line) return fail(line.error().code, who_ + ": isOn: " + line.error().what);
    const bool on = line->find(commands_.ask_on) != std::string::npos;
    const bool off = line->find(commands_.ask_off) != std::string::npos;
    if (on == off)
      return fail(Errc::kCorrupt,
                  who_ + ": isOn: it says '" + escape(*line) + "', neither ask_on nor ask_off");
    return std::optional<bool>(on);
  }
  Result<void> recover() override {
    if (auto opened = port_->open(); !opened) return named("recover", opened);
    return named("recover", tell(0));
  }

 private:
  MonoTime deadline() const { return clock_.mono() + commands_.timeout; }

  Result<void> tell(double level) {
    const bool on = level > 0;
    if (line_) return line_->drive(*port_, on);
    std::string command = on ? commands_.on : commands_.off;
    if (const auto at = command.find("{level}"); at != std::string::npos)
      command.replace(
          at, 7, std::to_string(std::max(on ? 1L : 0L, std::lround(level * commands_.levels))));
    const std::string& expected = on ? commands_.on_reply : commands_.off_reply;
    if (expected.empty()) return port_->send(command, deadline());
    const auto reply = port_->ask(command, expected, deadline());
    if (!reply) return tl::make_unexpected(reply.error());
    if (reply->find(expected) == std::string::npos)
      return fail(Errc::kCorrupt,
                  "it says '" + escape(*reply) + "' instead of '" + escape(expected) + "'");
    acknowledged_ = on;
    return {};
  }
  Result<void> named(const char* call, Result<void> done) const {
    if (done) return done;
    return fail(done.error().code, who_ + ": " + call + ": " + done.error().what);
  }

  LightCaps caps_;
  const Commands commands_;
  const std::optional<LineOutput> line_;
  const std::shared_ptr<Port> port_;
  Clock& clock_;
  const std::string who_;
  std::optional<bool> acknowledged_;  // what it said to the last command
};

}  // namespace

std::unique_ptr<Light> makeLightOn(std::shared_ptr<Port> port, const LightSpec& spec,
                                   const std::filesystem::path& rig_file, Clock& clock) {
  Settings settings(spec.settings, "light '" + spec.id + "'", rig_file);
  LightCaps caps = takeLightCaps(settings, spec.id);
  const auto line = takeLine(settings, "line");
  Commands commands = takeCommands(settings, !line);
  auto shared = portFor(std::move(port), settings, spec.address, line.has_value(), clock);
  settings.finish();
  return std::make_unique<SerialLight>(std::move(caps), std::move(commands), line,
                                       std::move(shared), clock);
}

std::unique_ptr<Light> makeLight(const LightSpec& spec, const std::filesystem::path& rig_file,
                                 Clock& clock) {
  return makeLightOn(nullptr, spec, rig_file, clock);
}

}  // namespace patina::devices::serial
