// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/export_frames.h"

#include <array>
#include <cctype>
#include <cstdio>

#include "capture/workflow/failure.h"
#include "db/failure.h"
#include "processing/image/sidecar_file.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;
using Captured = db::ArchiveReader::CapturedFrame;

constexpr const char* kManifestHead =
    "run_id,file,sha256,bytes,utc,step,decision,camera,light,exposure_index,exposure_ns,iso,"
    "f_number,attempt,file_index,width_px,height_px";

std::string plain(const std::string& name) {
  std::string text;
  for (const char c : name) {
    const bool kept =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '+' || c == '.';
    text += kept ? c : '-';
  }
  return text.empty() ? "none" : text;
}

std::string fileTime(UtcTime t) {
  std::string text;
  for (const char c : formatUtc(t))
    if (c != '-' && c != ':') text += c;
  return text;
}

std::string number(const char* format, double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

// A name with a comma or a quote in it is one field all the same.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string manifestLine(const std::string& run_id, const std::string& file, const Captured& c) {
  std::string line = field(run_id) + "," + field(file) + "," + c.frame.sha256.hex() + "," +
                     std::to_string(c.frame.bytes) + "," + formatUtc(c.frame.utc) + ",";
  if (c.step.number) line += std::to_string(*c.step.number);
  line += "," + std::string(db::name(c.step.decision)) + "," + field(c.shot.device_id) + "," +
          field(c.shot.light_state) + "," + std::to_string(c.shot.exposure_index) + "," +
          std::to_string(c.shot.exposure.count()) + "," + number("%g", c.shot.iso) + "," +
          number("%g", c.shot.f_number) + "," + std::to_string(c.shot.attempt) + "," +
          std::to_string(c.frame.file_index) + "," + std::to_string(c.frame.size.width) + "," +
          std::to_string(c.frame.size.height);
  return line + "\n";
}

void writeSidecar(const fs::path& picture, const Captured& c) {
  PictureMetadata said;
  said.taken_utc = c.frame.utc;
  if (c.shot.exposure > Nanoseconds{}) said.exposure = c.shot.exposure;
  if (c.shot.iso > 0) said.iso = Iso{c.shot.iso};
  if (c.shot.f_number > 0) said.f_number = FNumber{c.shot.f_number};
  said.camera = c.shot.device_id;
  writeFileAtomically(sidecarOf(picture), encodeSidecar(said));
}

class Export {
 public:
  Export(const db::ArchiveReader& reader, const std::string& run_id, const fs::path& out,
         const ExportOptions& options)
      : reader_(reader), out_(out), options_(options) {
    report_.run_id = run_id;
  }

  ExportReport run(Progress& progress) {
    begin();
    std::vector<Captured> frames;
    reader_.eachFrame(report_.run_id, [&](const Captured& c) { frames.push_back(c); });
    progress.begin("exporting frames", static_cast<std::int64_t>(frames.size()));
    std::string manifest = std::string(kManifestHead) + "\n", sums;
    for (const Captured& c : frames) {
      progress.step();
      const std::string name = exportName(c);
      if (!place(name, c)) continue;
      if (options_.sidecars) writeSidecar(out_ / name, c);
      ++report_.frames;
      manifest += manifestLine(report_.run_id, name, c);
      sums += c.frame.sha256.hex() + "  " + name + "\n";
    }
    writeFileAtomically(out_ / "SHA256SUMS", sums);
    writeFileAtomically(out_ / "manifest.csv", manifest);
    fs::remove(unfinished());
    return std::move(report_);
  }

 private:
  fs::path unfinished() const { return out_ / "UNFINISHED"; }

  // The run a folder's earlier export was of; empty when there was none.
  std::string earlierRun() const {
    const auto text = [](const fs::path& path) {
      const Bytes bytes = readFile(path);
      return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    if (fs::exists(unfinished())) return text(unfinished());
    if (!fs::exists(out_ / "manifest.csv")) return {};
    const std::string manifest = text(out_ / "manifest.csv");
    const auto line = manifest.find('\n');
    return line == std::string::npos
               ? std::string()
               : manifest.substr(line + 1, manifest.find(',', line) - line - 1);
  }

  void begin() const {
    if (fs::exists(out_) && !(fs::is_directory(out_) && fs::is_empty(out_))) {
      const std::string earlier = fs::is_directory(out_) ? earlierRun() : std::string();
      if (earlier != report_.run_id)
        throw WorkflowError(Exit::kCannotCreate,
                            out_.string() + " holds " +
                                (earlier.empty() ? "something else" : "run " + earlier) +
                                ": name an empty folder");
    }
    fs::create_directories(out_);
    writeFileAtomically(unfinished(), report_.run_id);
  }

  bool place(const std::string& name, const Captured& c) {
    const fs::path to = out_ / name;
    std::error_code error;
    if (fs::file_size(to, error) == static_cast<std::uintmax_t>(c.frame.bytes) && !error)
      return true;
    try {
      const Bytes bytes = reader_.read(c.frame);  // checks the hash
      fs::remove(to);
      if (options_.link) {
        fs::create_hard_link(reader_.pathOf(c.frame), to, error);
        if (!error) ++report_.linked;
      }
      if (!options_.link || error) {
        writeFileAtomically(to, bytes);
        ++report_.written;
        report_.bytes_written += bytes.size();
      }
      constexpr auto kRead = fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read;
      fs::permissions(to, kRead);
    } catch (const db::ArchiveError& e) {
      report_.problems.emplace_back(e.what());
      return false;
    }
    return true;
  }

  const db::ArchiveReader& reader_;
  fs::path out_;
  const ExportOptions& options_;
  ExportReport report_;
};

}  // namespace

std::string exportName(const Captured& c) {
  std::array<char, 24> step{};
  if (c.step.number)
    std::snprintf(step.data(), step.size(), "%06lld", static_cast<long long>(*c.step.number));
  std::string name = fileTime(c.frame.utc) + "_" + (c.step.number ? step.data() : "manual") + "_" +
                     plain(c.shot.device_id) + "_" + plain(c.shot.light_state) + "_e" +
                     std::to_string(c.shot.exposure_index);
  if (c.shot.attempt > 0) name += "_a" + std::to_string(c.shot.attempt);
  if (c.frame.file_index > 0) name += "_f" + std::to_string(c.frame.file_index);
  return name + "." + c.frame.ext;
}

ExportReport exportFrames(const db::ArchiveReader& reader, const std::string& run_id,
                          const fs::path& out, const ExportOptions& options, Progress& progress) {
  return Export(reader, run_id, out, options).run(progress);
}

}  // namespace patina::workflow
