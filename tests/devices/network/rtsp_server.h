// SPDX-License-Identifier: GPL-3.0-or-later
// A small RTSP server: H.264 over the connection's own channel. Grey frames, each a level of its
// own.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/support/loopback/loopback_server.h"

namespace patina::testing {

// A film ready to be sent: what describes it, and the packets of each frame.
struct RtspFilm {
  std::string sdp;
  std::vector<std::vector<std::string>> packets;  // RTP, by frame
};
// Frame n is grey of level 40 + 4 n; every `key_every`-th is a key frame.
RtspFilm greyFilm(int frames, int key_every);

// Serves it once, then is silent; `silent_after`: sends no more frames. `on_silence` is called when
// the last one is out.
void serveRtsp(Peer& peer, const RtspFilm& film, const std::string& address,
               std::size_t silent_after = 1'000'000, const std::function<void()>& on_silence = {});

}  // namespace patina::testing
