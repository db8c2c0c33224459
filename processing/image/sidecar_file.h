// SPDX-License-Identifier: GPL-3.0-or-later
// XMP sidecars: "frame.nef.xmp" says of frame.nef what the file itself does not, or not rightly.
#pragma once

#include <filesystem>

#include "processing/image/metadata_file.h"

namespace patina {

std::filesystem::path sidecarOf(const std::filesystem::path& picture);

// An XMP packet of what is known: time, exposure, ISO, f-number, camera. Pure. Throws
// ProcessingError(kBug) when Exiv2 cannot write it.
std::string encodeSidecar(const PictureMetadata& metadata);
// Absent or malformed values are absence.
PictureMetadata decodeSidecar(const std::string& xmp);

// Of the file, and where a sidecar lies beside it, its values instead.
PictureMetadata readMetadataOf(const std::filesystem::path& picture,
                               std::span<const std::byte> file);

}  // namespace patina
