// SPDX-License-Identifier: GPL-3.0-or-later
// patina device-host: devices in a process of their own, for the Patina that started it or, over
// TCP, for one on another machine.
#include <csignal>
#include <cstdio>

#include "capture/app/context.h"
#include "capture/app/rig/host_devices.h"
#include "capture/app/verbs/verbs.h"
#include "devices/host/listener.h"
#include "devices/host/seal.h"

namespace patina::app {
namespace {

namespace host = devices::host;

struct HostChoices {
  int fd = -1;
  std::string listen, key;
};

void serveOne(const HostChoices& chosen) {
  // A terminal's Ctrl-C is for the parent; its end is this one's.
  std::signal(SIGINT, SIG_IGN);
  host::Channel channel{devices::Descriptor(chosen.fd)};
  if (chosen.key.empty()) return host::serve(channel, rig::makeHosted, rig::findAttached);
  if (auto served =
          host::serveCaller(channel, host::readKey(chosen.key), rig::makeHosted, rig::findAttached);
      !served)
    throw AppError(Exit::kPermission, served.error().what);
}

void listen(Context& context, const HostChoices& chosen) {
  host::readKey(chosen.key);  // now, rather than with the first caller
  std::stop_source stop;
  context.signals.onStop([&stop] { stop.request_stop(); });
  host::ListenOptions options;
  options.address = chosen.listen;
  options.command = {"/proc/self/exe", "device-host", "--key",
                     std::filesystem::absolute(chosen.key).string()};
  options.on_listening = [&](int port) {
    if (context.options.quiet) return;
    std::fprintf(stderr,
                 "Serving this machine's devices on port %d to whoever has the key of %s.\n", port,
                 chosen.key.c_str());
  };
  const auto listened = host::listenForCallers(options, stop.get_token());
  context.signals.onStop({});
  if (!listened) throw AppError(Exit::kUnavailable, listened.error().what);
}

void run(Context& context, const HostChoices& chosen) {
  if (chosen.fd >= 0) return serveOne(chosen);
  if (chosen.listen.empty())
    throw AppError(Exit::kUsage, "say where to listen: --listen 0.0.0.0:8461");
  if (chosen.key.empty())
    throw AppError(Exit::kUsage,
                   "name the shared key's file with --key; `openssl rand -hex 32` writes one");
  listen(context, chosen);
}

}  // namespace

void addDeviceHostVerb(Verb root) {
  auto chosen = std::make_shared<HostChoices>();
  Verb verb = root.verb("device-host",
                        "Serves this machine's devices to a Patina elsewhere, which has a [[host]] "
                        "in its rig file and the same key",
                        "patina device-host --listen 0.0.0.0:8461 --key pi.key",
                        [chosen](Context& context) { run(context, *chosen); });
  verb.option("--listen", chosen->listen, "ADDRESS:PORT", "Where to be called")
      .option("--key", chosen->key, "FILE", "The shared key, mode 0600")
      .option("--fd", chosen->fd, 3, 1 << 20, "A connection that is there already")
      .conceal("--fd");
}

}  // namespace patina::app
