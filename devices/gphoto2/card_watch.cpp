// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/card_watch.h"

#include <algorithm>

namespace patina::devices::gphoto2 {

namespace {

constexpr std::size_t kEventsMost = 100;

bool isRaw(const CardFile& file) { return file.extension() != "jpg"; }

bool sameShot(const CardFile& a, const CardFile& b) {
  return a.folder == b.folder && a.stem() == b.stem();
}

std::string below(const std::string& folder, const std::string& name) {
  return folder == "/" ? "/" + name : folder + "/" + name;
}

// Where new pictures appear: each storage's root, and the newest folder in its DCIM.
Result<std::vector<std::string>> folders(Session& session) {
  std::vector<std::string> found;
  std::vector<std::string> roots{"/"};
  const auto stores = session.listFolders("/");
  if (!stores) return tl::make_unexpected(stores.error());
  for (const std::string& store : *stores)
    if (store.starts_with("store_")) roots.push_back(below("/", store));
  for (const std::string& root : roots) {
    const auto inner = session.listFolders(root);
    if (!inner) return tl::make_unexpected(inner.error());
    if (root != "/" || roots.size() == 1) found.push_back(root);
    if (std::find(inner->begin(), inner->end(), "DCIM") == inner->end()) continue;
    const std::string dcim = below(root, "DCIM");
    const auto numbered = session.listFolders(dcim);
    if (!numbered) return tl::make_unexpected(numbered.error());
    if (!numbered->empty())
      found.push_back(below(dcim, *std::max_element(numbered->begin(), numbered->end())));
  }
  return found;
}

Result<std::vector<CardFile>> filesNow(Session& session) {
  session.forgetListing();
  const auto places = folders(session);
  if (!places) return tl::make_unexpected(places.error());
  std::vector<CardFile> all;
  for (const std::string& folder : *places) {
    auto files = session.list(folder);
    if (!files) return files;
    all.insert(all.end(), files->begin(), files->end());
  }
  return all;
}

}  // namespace

Result<void> CardWatch::learn(Session& session) {
  const auto files = filesNow(session);
  if (!files) return tl::make_unexpected(files.error());
  seen_.forget();
  for (const CardFile& file : *files) seen_.note(file);
  return {};
}

void CardWatch::added(const CardFile& file, MonoTime now) {
  if (seen_.known(file)) return;
  const bool rises = seen_.rises(file);
  seen_.note(file);
  waiting_.push_back({file, now, rises});
}

Result<void> CardWatch::refresh(Session& session, MonoTime now) {
  const auto files = filesNow(session);
  if (!files) return tl::make_unexpected(files.error());
  for (const CardFile& file : *files) added(file, now);
  return {};
}

std::optional<std::vector<Arrival>> CardWatch::complete(FileKinds kinds) const {
  for (const Arrival& first : waiting_) {
    const Arrival *raw = nullptr, *jpeg = nullptr;
    for (const Arrival& other : waiting_)
      if (sameShot(first.file, other.file)) (isRaw(other.file) ? raw : jpeg) = &other;
    if ((kinds.raw && !raw) || (kinds.jpeg && !jpeg)) continue;
    std::vector<Arrival> files;
    if (kinds.raw) files.push_back(*raw);
    if (kinds.jpeg) files.push_back(*jpeg);
    return files;
  }
  return std::nullopt;
}

std::string CardWatch::waitingFor() const {
  std::string text;
  for (const Arrival& arrival : waiting_) text += (text.empty() ? "" : ", ") + arrival.file.name;
  return text.empty() ? "nothing" : text;
}

void CardWatch::forget(const std::vector<Arrival>& files) {
  std::erase_if(waiting_, [&](const Arrival& waiting) {
    return std::any_of(files.begin(), files.end(),
                       [&](const Arrival& gone) { return gone.file == waiting.file; });
  });
}

void CardWatch::claim(const std::vector<Arrival>& files) { forget(files); }

void CardWatch::disown(const std::vector<Arrival>& files, const std::string& why) {
  forget(files);
  for (const Arrival& arrival : files) {
    if (events_.size() >= kEventsMost) events_.erase(events_.begin());
    events_.push_back({"camera '" + who_ + "': unclaimed picture " + arrival.file.path() + ": " +
                       why + "; it stays on the card"});
  }
}

void CardWatch::disownAll(const std::string& why) { disown(std::vector<Arrival>(waiting_), why); }

}  // namespace patina::devices::gphoto2
