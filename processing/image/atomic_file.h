// SPDX-License-Identifier: GPL-3.0-or-later
// For writers that need a file name rather than bytes (films, HDF5): write to temporaryBeside(),
// then publishAtomically(). A reader sees the old file or the whole new one.
#pragma once

#include <filesystem>
#include <functional>

namespace patina {

// A name in the same folder that no other call of this process and no other process uses.
std::filesystem::path temporaryBeside(const std::filesystem::path& path);

// fsync of the file, rename over `path`, fsync of the folder. On failure removes the temporary file
// and throws ProcessingError (kIo, kCannotCreate when the disk is full, kPermission).
void publishAtomically(const std::filesystem::path& temporary, const std::filesystem::path& path);

// A folder that appears whole: `fill` writes into one beside it, which then takes the place of
// `folder`, also of one that was there. On failure nothing of it stays; throws what `fill` throws,
// or ProcessingError(kCannotCreate).
void writeFolderAtomically(const std::filesystem::path& folder,
                           const std::function<void(const std::filesystem::path&)>& fill);

}  // namespace patina
