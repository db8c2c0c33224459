// SPDX-License-Identifier: GPL-3.0-or-later
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/log.h>
#include <libswscale/swscale.h>
}

#include "processing/image/libav.h"

namespace patina {

void FreeLibav::operator()(AVCodecContext* c) const { avcodec_free_context(&c); }
void FreeLibav::operator()(AVFrame* f) const { av_frame_free(&f); }
void FreeLibav::operator()(AVPacket* p) const { av_packet_free(&p); }
void FreeLibav::operator()(SwsContext* s) const { sws_freeContext(s); }

std::string libavText(int error) {
  char text[AV_ERROR_MAX_STRING_SIZE] = "";
  av_strerror(error, text, sizeof text);
  return text;
}

void silenceLibav() { av_log_set_level(AV_LOG_QUIET); }

}  // namespace patina
