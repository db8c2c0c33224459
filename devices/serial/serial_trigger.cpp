// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include "devices/serial/escapes.h"
#include "devices/serial/line_output.h"
#include "devices/serial/serial.h"
#include "devices/trigger_pulse.h"

namespace patina::devices::serial {
namespace {

using namespace std::chrono_literals;

struct Fire {
  std::optional<LineOutput> line, half_line;
  TriggerPulse pulse;
  std::string command, reply;
  Nanoseconds timeout{};
};

Fire takeFire(Settings& settings) {
  Fire fire;
  fire.line = takeLine(settings, "line");
  fire.half_line = takeLine(settings, "half_line");
  fire.pulse = takeTriggerPulse(settings);
  fire.command = takeBytes(settings, "fire");
  fire.reply = takeBytes(settings, "reply");
  fire.timeout = settings.takeDuration("timeout", 10ms, 10s, 1s);
  if (fire.line.has_value() != fire.command.empty()) settings.reject("line", "give line or fire");
  if (fire.half_line && (!fire.line || fire.line->line == fire.half_line->line))
    settings.reject("half_line", "must be the other one of rts and dtr, beside line");
  if (!fire.reply.empty() && fire.command.empty())
    settings.reject("reply", "needs fire: a control line does not answer");
  return fire;
}

class SerialTrigger final : public Trigger {
 public:
  SerialTrigger(std::string id, Fire fire, std::shared_ptr<Port> port, Clock& clock)
      : id_(std::move(id)), fire_(std::move(fire)), port_(std::move(port)), clock_(clock) {}
  ~SerialTrigger() override { static_cast<void>(letGo()); }

  const std::string& id() const override { return id_; }
  Result<MonoTime> fire() override {
    const auto at = fire_.line ? press() : command();
    if (!at) return fail(at.error().code, "serial '" + id_ + "': fire: " + at.error().what);
    return *at;
  }
  Result<void> recover() override {
    auto done = port_->open();
    if (done) done = letGo();
    if (!done)
      return fail(done.error().code, "serial '" + id_ + "': recover: " + done.error().what);
    return done;
  }

 private:
  Result<MonoTime> press() {
    LineDrive half;
    if (fire_.half_line) half = [this](bool on) { return fire_.half_line->drive(*port_, on); };
    return devices::press(
        fire_.pulse, [this](bool on) { return fire_.line->drive(*port_, on); }, half, clock_);
  }
  Result<MonoTime> command() {
    const MonoTime deadline = clock_.mono() + fire_.timeout;
    if (fire_.reply.empty()) {
      if (auto sent = port_->send(fire_.command, deadline); !sent)
        return tl::make_unexpected(sent.error());
      return clock_.mono();
    }
    const MonoTime sent = clock_.mono();
    const auto reply = port_->ask(fire_.command, fire_.reply, deadline);
    if (!reply) return tl::make_unexpected(reply.error());
    if (reply->find(fire_.reply) == std::string::npos)
      return devices::fail(Errc::kCorrupt, "it says '" + escape(*reply) + "' instead of '" +
                                               escape(fire_.reply) + "'");
    return sent;
  }
  Result<void> letGo() {
    for (const auto& line : {fire_.line, fire_.half_line})
      if (line)
        if (auto done = line->drive(*port_, false); !done) return done;
    return {};
  }

  const std::string id_;
  const Fire fire_;
  const std::shared_ptr<Port> port_;
  Clock& clock_;
};

}  // namespace

std::unique_ptr<Trigger> makeTriggerOn(std::shared_ptr<Port> port, const TriggerSpec& spec,
                                       const std::filesystem::path& rig_file, Clock& clock) {
  Settings settings(spec.settings, "trigger '" + spec.id + "'", rig_file);
  Fire fire = takeFire(settings);
  auto shared = portFor(std::move(port), settings, spec.address, fire.line.has_value(), clock);
  settings.finish();
  return std::make_unique<SerialTrigger>(spec.id, std::move(fire), std::move(shared), clock);
}

std::unique_ptr<Trigger> makeTrigger(const TriggerSpec& spec, const std::filesystem::path& rig_file,
                                     Clock& clock) {
  return makeTriggerOn(nullptr, spec, rig_file, clock);
}

}  // namespace patina::devices::serial
