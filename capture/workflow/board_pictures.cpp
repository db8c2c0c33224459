// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/board_pictures.h"

#include <glob.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "capture/workflow/failure.h"
#include "capture/workflow/import_listing.h"
#include "capture/workflow/picture_times.h"
#include "processing/image/metadata_file.h"
#include "processing/image/picture_file.h"
#include "processing/image/sha256.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;
using calibration::BoardSpec;

constexpr std::size_t kAtATime = 4;
constexpr std::size_t kKeptForProbing = 3;

std::vector<fs::path> matching(const std::string& pattern) {
  std::vector<fs::path> files;
  glob_t found{};
  if (::glob(pattern.c_str(), 0, nullptr, &found) == 0)
    for (std::size_t i = 0; i < found.gl_pathc; ++i) files.emplace_back(found.gl_pathv[i]);
  ::globfree(&found);
  return files;
}

std::vector<fs::path> inFolder(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && isPictureFile(entry.path())) files.push_back(entry.path());
  return files;
}

void refuse(const std::string& what) { throw WorkflowError(Exit::kBadData, what); }

std::string sizeText(SizePx size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::string namesOf(const BoardPictures& all) {
  std::string names;
  for (const BoardPicture& picture : all.pictures) {
    if (picture.sight) continue;
    if (!names.empty()) names.append(", ");
    names.append(picture.name);
  }
  return names;
}

// Whether the pictures show the board that was told.
void judge(const BoardPictures& all, const std::vector<Image<float>>& seen,
           const std::vector<Image<float>>& unseen, const BoardSpec& board, std::size_t least) {
  const auto found = static_cast<std::size_t>(std::count_if(
      all.pictures.begin(), all.pictures.end(), [](const auto& p) { return p.sight.has_value(); }));
  const bool enough = found >= least;
  if (const auto shown = boardShown(enough ? seen : unseen, board, enough))
    refuse("the board in these pictures has " + describe(*shown) + ", not " +
           std::to_string(board.columns) + "x" + std::to_string(board.rows) + ": give --board " +
           std::to_string(shown->columns) + "x" + std::to_string(shown->rows) +
           " (inner corners: one less than squares each way)");
  if (enough) return;
  const std::string board_text = board.kind == BoardSpec::kCharuco
                                     ? "a " + describe(board) + " (4x4 markers)"
                                     : "a board of " + describe(board);
  refuse(board_text + " was found in " + std::to_string(found) + " of " +
         std::to_string(all.pictures.size()) + " pictures, and " + std::to_string(least) +
         " are needed; not in " + namesOf(all) +
         ". All of a chessboard must be in the picture, sharp, evenly lit, with a white rim");
}

}  // namespace

std::vector<fs::path> picturesNamed(const std::vector<std::string>& sources) {
  std::vector<fs::path> all;
  for (const std::string& source : sources) {
    std::vector<fs::path> files;
    if (fs::is_directory(source))
      files = inFolder(source);
    else if (fs::exists(source))
      files = {source};
    else
      files = matching(source);
    if (files.empty()) throw WorkflowError(Exit::kUsage, "no picture is called " + source);
    std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
      return naturalLess(a.string(), b.string());
    });
    for (const fs::path& file : files)
      if (std::find(all.begin(), all.end(), file) == all.end()) all.push_back(file);
  }
  return all;
}

BoardPictures searchBoards(const std::vector<fs::path>& files, const BoardSpec& board,
                           std::size_t least, UtcTime now, Progress& progress) {
  board.check();
  BoardPictures all;
  all.taken = now;
  all.pictures.resize(files.size());
  std::vector<Image<float>> seen, unseen;
  CommonZoom common;
  progress.begin("boards", static_cast<std::int64_t>(files.size()));
  for (std::size_t first = 0; first < files.size(); first += kAtATime) {
    const std::size_t count = std::min(kAtATime, files.size() - first);
    std::vector<Image<float>> greys(count);
    std::vector<Zoom> zooms(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      BoardPicture& picture = all.pictures[first + i];
      const Bytes bytes = readFile(files[first + i]);
      picture.name = files[first + i].filename().string();
      picture.sha256 = sha256(bytes).hex();
      zooms[i] = zoomOf(bytes);
      greys[i] = calibration::greyOf(decodePicture(bytes).linear.view());
      picture.sight = findBoard(greys[i].view(), board);
    });
    for (std::size_t i = 0; i < count; ++i) {
      if (first + i == 0) all.size = greys[i].size();
      if (greys[i].size() != all.size)
        refuse(all.pictures[first + i].name + " is " + sizeText(greys[i].size()) + " pixels and " +
               all.pictures[0].name + " is " + sizeText(all.size) +
               ": pictures of one camera at one size are needed");
      common.add(zooms[i], all.pictures[first + i].name);
      std::vector<Image<float>>& kept = all.pictures[first + i].sight ? seen : unseen;
      if (kept.size() < kKeptForProbing) kept.push_back(std::move(greys[i]));
    }
    progress.step(static_cast<std::int64_t>(count));
  }
  judge(all, seen, unseen, board, least);
  const PictureMetadata about = readMetadata(readFile(files[files.size() / 2]));
  all.zoom = common.zoom();
  all.says_when = about.taken_utc.has_value();
  all.taken = about.taken_utc.value_or(now);
  return all;
}

}  // namespace patina::workflow
