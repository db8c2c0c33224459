// SPDX-License-Identifier: GPL-3.0-or-later
// The files that appear on a camera's card. Events tell of them, twice, late or never; the listing
// tells the truth, at a price.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "devices/camera.h"
#include "devices/gphoto2/picture_proof.h"
#include "devices/gphoto2/session.h"

namespace patina::devices::gphoto2 {

struct Arrival {
  CardFile file;
  MonoTime at;         // when the card first showed it
  bool rises = false;  // its number was above all before it
};

class CardWatch {
 public:
  explicit CardWatch(std::string who) : who_(std::move(who)) {}

  // What is there when a session begins is nobody's. O(files of the newest folder).
  Result<void> learn(Session& session);
  void added(const CardFile& file, MonoTime now);
  // Looks for what no event told of.
  Result<void> refresh(Session& session, MonoTime now);

  // The oldest shot whose files are all there: RAW first, then JPEG.
  std::optional<std::vector<Arrival>> complete(FileKinds kinds) const;
  std::string waitingFor() const;  // for messages: "DSC_0001.NEF", "nothing"

  void claim(const std::vector<Arrival>& files);  // taken by a shot
  // Left on the card, for a person to look at; one event each.
  void disown(const std::vector<Arrival>& files, const std::string& why);
  void disownAll(const std::string& why);
  void erased(const CardFile& file) { seen_.erased(file); }

  std::vector<CameraEvent> takeEvents() { return std::exchange(events_, {}); }

 private:
  void forget(const std::vector<Arrival>& files);

  std::string who_;
  SeenNames seen_;
  std::vector<Arrival> waiting_;  // in order of arrival
  std::vector<CameraEvent> events_;
};

}  // namespace patina::devices::gphoto2
