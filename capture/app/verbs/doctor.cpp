// SPDX-License-Identifier: GPL-3.0-or-later
// patina doctor: what would spoil a week, and what to do about it.
#include "capture/app/context.h"
#include "capture/app/rig/attached.h"
#include "capture/app/verbs/verbs.h"
#include "capture/doctor/commit_probe.h"
#include "capture/doctor/judge.h"

namespace patina::app {
namespace {

// Beside the archive's own files, on its disk; a folder that does not exist yet is not made.
void probe(Context& context, doctor::ArchiveFacts& facts) {
  if (!facts.writable || !facts.refused.empty()) return;
  try {
    const auto latency = doctor::probeCommits(facts.there, context.clock);
    facts.commit_median = latency.median;
    facts.commit_worst = latency.worst;
  } catch (const Failure& failure) {
    facts.probe_failed = failure.what();
  }
}

// What every backend sees, and what is wrong with it.
std::vector<doctor::Finding> examineDevices(Context& context) {
  constexpr Nanoseconds kLimit = std::chrono::seconds(20);
  context.progress.status("looking for devices");
  const rig::Attached attached = rig::findAll(kLimit);
  context.progress.clear();
  std::vector<doctor::Finding> findings;
  for (const devices::FoundDevice& d : attached.devices) {
    const std::string& name = d.serial.empty() ? d.address : d.serial;
    const std::string subject = d.kind + " " + (d.model.empty() ? d.backend : d.model) + " " + name;
    if (d.troubles.empty()) findings.push_back({subject, doctor::Level::kOk, d.state, ""});
    for (const devices::Trouble& trouble : d.troubles)
      findings.push_back({subject, trouble.fatal ? doctor::Level::kFail : doctor::Level::kWarn,
                          trouble.what, trouble.do_this});
  }
  for (const auto& [backend, why] : attached.failures)
    findings.push_back({"devices of " + backend, doctor::Level::kWarn,
                        "could not be looked for: " + why,
                        "unplug what hangs, plug it in again and ask once more"});
  return findings;
}

void examine(Context& context) {
  auto findings = doctor::judge(doctor::machineFacts());
  for (doctor::Finding& finding : examineDevices(context)) findings.push_back(std::move(finding));
  if (context.options.archive.empty()) {
    context.out.say("No archive named: its disk was not looked at (--archive DIR).");
  } else {
    doctor::ArchiveFacts facts = doctor::archiveFacts(context.options.archive);
    probe(context, facts);
    for (doctor::Finding& finding : doctor::judge(facts)) findings.push_back(std::move(finding));
  }
  for (const doctor::Finding& f : findings) {
    if (f.level == doctor::Level::kFail) context.exit_code = static_cast<int>(Exit::kConfig);
    context.out.add(std::move(Item()
                                  .set("level", doctor::name(f.level))
                                  .set("subject", f.subject.c_str())
                                  .set("what", f.what.c_str())
                                  .set("do", f.do_this.c_str())));
  }
}

}  // namespace

void addDoctorVerb(Verb root) {
  root.verb("doctor",
            "What would spoil a week: disk, clock, sleep, limits, every device; exit 78 when "
            "something does",
            "patina doctor --archive ivy", [](Context& context) { examine(context); });
}

}  // namespace patina::app
