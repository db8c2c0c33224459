// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/frame_check.h"

#include <algorithm>

#include "calibration/failure.h"
#include "processing/image/dng_file.h"

namespace patina::capture {
namespace {

constexpr std::size_t kKnownMost = 16;  // files of a camera that has failed for long

// 0x0: of any size, as long as none is known.
bool fits(SizePx size, SizePx due) { return due == SizePx{} || size == due; }

std::string text(SizePx s) { return std::to_string(s.width) + "x" + std::to_string(s.height); }

// What one decode gives.
struct Decoded {
  bool raw = false;
  SizePx size;
  int bits = 0;
  double saturated_fraction = 0;
  bool all_equal = false;
  std::optional<calibration::PatchLevel> patch;
  std::optional<calibration::TileLevels> tiles;
};

int bitsBelow(double white_level) {
  int bits = 1;
  while (bits < 32 && static_cast<double>((1ull << bits) - 1) < white_level) ++bits;
  return bits;
}

template <class T>
bool allEqual(const std::vector<T>& texels) {
  return std::all_of(texels.begin(), texels.end(), [&](T v) { return v == texels.front(); });
}

Decoded decodeMosaic(std::span<const std::byte> file, std::optional<RectPx> patch) {
  const RawMosaic raw = decodeRaw(file);
  Decoded d;
  d.raw = true;
  d.size = raw.samples.size();
  d.bits = bitsBelow(raw.white_level);
  const auto& samples = raw.samples.texels();
  const auto full = std::count_if(samples.begin(), samples.end(),
                                  [&](std::uint16_t v) { return v >= raw.white_level; });
  d.saturated_fraction = static_cast<double>(full) / static_cast<double>(samples.size());
  d.all_equal = allEqual(samples);
  if (!patch) return d;
  d.patch = calibration::measurePatch(raw.samples.view(), raw.cfa, raw.black_level, raw.white_level,
                                      *patch);
  d.tiles = calibration::measureTiles(raw.samples.view(), raw.black_level, raw.white_level, *patch);
  return d;
}

Decoded decodeDeveloped(std::span<const std::byte> file, std::optional<RectPx> patch) {
  const Picture picture = decodePicture(file);
  Decoded d;
  d.size = picture.linear.size();
  d.bits = picture.bits;
  d.saturated_fraction = picture.saturated_fraction;
  d.all_equal = allEqual(picture.linear.texels());
  if (!patch) return d;
  d.patch = calibration::measurePatch(picture.linear.view(), *patch);
  d.tiles = calibration::measureTiles(picture.linear.view(), *patch);
  return d;
}

bool isRaw(std::span<const std::byte> file) {
  const PictureFormat format = sniffFormat(file);
  return format == PictureFormat::kDng || format == PictureFormat::kRaw;
}

}  // namespace

calibration::TileLevels tilesOf(std::span<const std::byte> file, RectPx patch) {
  return *(isRaw(file) ? decodeMosaic(file, patch) : decodeDeveloped(file, patch)).tiles;
}

const char* name(FrameFault fault) {
  switch (fault) {
    case FrameFault::kNone:
      return "none";
    case FrameFault::kMissingFile:
      return "missing_file";
    case FrameFault::kLength:
      return "length";
    case FrameFault::kDecode:
      return "decode";
    case FrameFault::kWrongSize:
      return "wrong_size";
    case FrameFault::kDuplicate:
      return "duplicate";
    case FrameFault::kStaleSequence:
      return "stale";
  }
  return "?";
}

FrameCheck::FrameCheck(const devices::CameraCaps& caps, std::optional<RectPx> patch)
    : caps_(caps), patch_(patch) {}

SizePx FrameCheck::sizeOf(const devices::RawFrame& frame) const {
  const auto learned = learned_.find(frame.file_index);
  return caps_.size == SizePx{} && learned != learned_.end() ? learned->second.size : caps_.size;
}

int FrameCheck::bitsOf(const devices::RawFrame& frame) const {
  const auto learned = learned_.find(frame.file_index);
  return caps_.bits == 0 && learned != learned_.end() ? learned->second.bits : caps_.bits;
}

void FrameCheck::refuse(ShotCheck& out, FrameFault fault, std::string detail) const {
  if (out.fault != FrameFault::kNone) return;  // the first reason is the one to tell
  out.fault = fault;
  out.detail = "camera '" + caps_.id + "': " + std::move(detail);
}

const SeenFile* FrameCheck::knownAs(const SeenFile& seen) const {
  const auto known = std::ranges::find_if(known_, [&](const SeenFile& k) {
    return k.file_index == seen.file_index && k.sha256 == seen.sha256;
  });
  return known == known_.end() ? nullptr : &*known;
}

void FrameCheck::checkFile(const devices::RawFrame& frame, const SeenFile& seen,
                           ShotCheck& out) const {
  const auto length = static_cast<std::int64_t>(frame.bytes.size());
  if (length == 0) return refuse(out, FrameFault::kLength, "an empty file");
  if (frame.seen && !frame.seen->refused.empty())
    return refuse(out, FrameFault::kDecode, frame.seen->refused);
  if (frame.declared_bytes && *frame.declared_bytes != length)
    return refuse(out, FrameFault::kLength,
                  "file of " + std::to_string(length) + " bytes, declared " +
                      std::to_string(*frame.declared_bytes));
  CheckedFrame checked;
  checked.frame = &frame;
  checked.sha256 = seen.sha256;
  const SeenFile* repeated = knownAs(seen);

  const bool first = frame.file_index == 0;
  const SizePx due = sizeOf(frame);
  Decoded d;
  try {
    const bool raw = isRaw(frame.bytes);
    const auto patch = first ? patch_ : std::nullopt;
    // The size comes first: a patch measured on a picture of another size means nothing.
    const SizePx claimed = raw ? due : readPictureHeader(frame.bytes).size;
    if (!fits(claimed, due))
      return refuse(out, FrameFault::kWrongSize,
                    "picture of " + text(claimed) + ", contract " + text(due));
    d = raw ? decodeMosaic(frame.bytes, patch) : decodeDeveloped(frame.bytes, patch);
  } catch (const ProcessingError& error) {
    return refuse(out, FrameFault::kDecode, error.what());
  } catch (const calibration::CalibrationError& error) {
    return refuse(out, FrameFault::kWrongSize, error.what());
  }
  if (!fits(d.size, due))
    return refuse(out, FrameFault::kWrongSize,
                  "picture of " + text(d.size) + ", contract " + text(due));
  if (const int bits = bitsOf(frame); first && bits != 0 && d.bits != bits)
    return refuse(
        out, FrameFault::kWrongSize,
        "samples of " + std::to_string(d.bits) + " bits, contract " + std::to_string(bits));
  // Two developed pictures of the dark may be equal, if neither was to show anything. Raw ones have
  // noise, and a real camera's its time and counters.
  if (repeated && (d.raw || seen.lit || repeated->lit) && !d.all_equal)
    return refuse(out, FrameFault::kDuplicate, "the previous picture came again as a new one");
  checked.size = d.size;
  checked.bits = d.bits;
  checked.saturated_fraction = d.saturated_fraction;
  out.frames.push_back(checked);
  if (!first) return;
  out.patch = d.patch;
  out.tiles = std::move(d.tiles);
  out.saturated_fraction = d.saturated_fraction;
  out.all_equal = d.all_equal;
}

ShotCheck FrameCheck::check(const std::vector<devices::RawFrame>& frames,
                            const devices::Ticket& ticket, bool lit) const {
  ShotCheck out;
  std::vector<const devices::RawFrame*> files(std::max<std::size_t>(caps_.extensions.size(), 1));
  for (const devices::RawFrame& frame : frames) {
    if (frame.sequence != 0 && frame.sequence != ticket.sequence) {
      out.remarks.push_back("camera '" + caps_.id + "': a picture of another shot came (" +
                            std::to_string(frame.sequence) + ", asked " +
                            std::to_string(ticket.sequence) + "); it fills no step");
      continue;
    }
    const auto index = static_cast<std::size_t>(frame.file_index);
    if (frame.file_index < 0 || index >= files.size()) {
      refuse(out, FrameFault::kMissingFile,
             "file number " + std::to_string(frame.file_index) + " of a shot of " +
                 std::to_string(files.size()));
      return out;
    }
    if (files[index])
      out.remarks.push_back("camera '" + caps_.id + "': file " + std::to_string(frame.file_index) +
                            " came twice; kept once");
    else
      files[index] = &frame;
  }
  for (const devices::RawFrame* file : files)
    if (file) out.came.push_back({file->file_index, sha256(file->bytes), lit});
  auto seen = out.came.cbegin();
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i]) {
      checkFile(*files[i], *seen++, out);
    } else if (frames.empty() || out.remarks.empty()) {
      refuse(out, FrameFault::kMissingFile,
             "file " + std::to_string(i) + " of the shot is missing");
    } else {
      refuse(out, FrameFault::kStaleSequence, "only pictures of other shots came");
    }
    if (out.fault != FrameFault::kNone) break;
  }
  return out;
}

void FrameCheck::remember(const ShotCheck& seen) {
  if (seen.fault == FrameFault::kNone) {
    known_.clear();
    for (const CheckedFrame& frame : seen.frames)
      learned_.try_emplace(frame.frame->file_index, Learned{frame.size, frame.bits});
  }
  for (const SeenFile& file : seen.came) {
    if (knownAs(file)) continue;
    // The good picture stays: its files are the oldest.
    if (known_.size() == kKnownMost) known_.erase(known_.begin() + kKnownMost / 2);
    known_.push_back(file);
  }
}

}  // namespace patina::capture
