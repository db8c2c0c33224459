// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/devices/network/rtsp_server.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
}

#include <cstring>
#include <stdexcept>

namespace patina::testing {
namespace {

constexpr int kWidth = 64, kHeight = 48, kPacketBytes = 1200;

void need(bool good, const char* what) {
  if (!good) throw std::runtime_error(std::string("rtsp test film: ") + what);
}

int keepPacket(void* user, std::uint8_t* bytes, int size) {
  auto& film = *static_cast<RtspFilm*>(user);
  // Reports of the sender (RTCP) have types 200 to 204.
  const bool report = size > 1 && bytes[1] >= 200 && bytes[1] <= 204;
  if (!report && !film.packets.empty())
    film.packets.back().emplace_back(reinterpret_cast<const char*>(bytes),
                                     static_cast<std::size_t>(size));
  return size;
}

AVCodecContext* makeEncoder(int key_every) {
  const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_H264);
  need(codec != nullptr, "no encoder of H.264");
  AVCodecContext* encoder = avcodec_alloc_context3(codec);
  encoder->width = kWidth;
  encoder->height = kHeight;
  encoder->pix_fmt = AV_PIX_FMT_YUV420P;
  encoder->time_base = {1, 25};
  encoder->gop_size = key_every;
  encoder->max_b_frames = 0;
  encoder->thread_count = 1;
  encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  av_opt_set(encoder->priv_data, "tune", "zerolatency", 0);
  av_opt_set(encoder->priv_data, "preset", "ultrafast", 0);
  need(avcodec_open2(encoder, codec, nullptr) >= 0, "the encoder does not open");
  return encoder;
}

std::string sequenceOf(const std::string& request) {
  const std::size_t at = request.find("CSeq: ");
  return at == std::string::npos ? "0" : request.substr(at + 6, request.find('\r', at) - at - 6);
}

std::string reply(const std::string& request, const std::string& headers,
                  const std::string& body = {}) {
  return "RTSP/1.0 200 OK\r\nCSeq: " + sequenceOf(request) + "\r\n" + headers +
         (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") + "\r\n" +
         body;
}

std::string interleaved(const std::string& packet) {
  std::string framed{'$', 0};
  framed += static_cast<char>(packet.size() >> 8);
  framed += static_cast<char>(packet.size() & 255);
  return framed + packet;
}

}  // namespace

RtspFilm greyFilm(int frames, int key_every) {
  av_log_set_level(AV_LOG_QUIET);
  RtspFilm film;
  AVCodecContext* encoder = makeEncoder(key_every);
  AVFormatContext* muxer = nullptr;
  avformat_alloc_output_context2(&muxer, nullptr, "rtp", nullptr);
  need(muxer != nullptr, "no RTP");
  auto* buffer = static_cast<unsigned char*>(av_malloc(kPacketBytes));
  muxer->pb = avio_alloc_context(buffer, kPacketBytes, 1, &film, nullptr, keepPacket, nullptr);
  muxer->pb->max_packet_size = kPacketBytes;
  AVStream* stream = avformat_new_stream(muxer, nullptr);
  avcodec_parameters_from_context(stream->codecpar, encoder);
  stream->time_base = encoder->time_base;
  need(avformat_write_header(muxer, nullptr) >= 0, "no head");
  char sdp[4096] = "";
  need(av_sdp_create(&muxer, 1, sdp, sizeof sdp) >= 0, "no SDP");
  film.sdp = sdp;
  AVFrame* frame = av_frame_alloc();
  frame->format = encoder->pix_fmt;
  frame->width = kWidth;
  frame->height = kHeight;
  av_frame_get_buffer(frame, 0);
  AVPacket* packet = av_packet_alloc();
  for (int n = 0; n < frames; ++n) {
    av_frame_make_writable(frame);
    std::memset(frame->data[0], 40 + 4 * n, static_cast<std::size_t>(frame->linesize[0]) * kHeight);
    for (int plane : {1, 2})
      std::memset(frame->data[plane], 128,
                  static_cast<std::size_t>(frame->linesize[plane]) * kHeight / 2);
    frame->pts = n;
    film.packets.emplace_back();
    avcodec_send_frame(encoder, frame);
    while (avcodec_receive_packet(encoder, packet) >= 0) {
      av_packet_rescale_ts(packet, encoder->time_base, stream->time_base);
      av_write_frame(muxer, packet);
      av_packet_unref(packet);
    }
  }
  avio_flush(muxer->pb);
  av_packet_free(&packet);
  av_frame_free(&frame);
  avcodec_free_context(&encoder);
  av_free(muxer->pb->buffer);
  avio_context_free(&muxer->pb);
  avformat_free_context(muxer);
  return film;
}

void serveRtsp(Peer& peer, const RtspFilm& film, const std::string& address,
               std::size_t silent_after, const std::function<void()>& on_silence) {
  const std::string base = "rtsp://" + address + "/live";
  for (std::string request = peer.receiveHead(); !request.empty(); request = peer.receiveHead()) {
    if (request.rfind("OPTIONS", 0) == 0) {
      peer.send(reply(request, "Public: OPTIONS, DESCRIBE, SETUP, PLAY, TEARDOWN\r\n"));
    } else if (request.rfind("DESCRIBE", 0) == 0) {
      peer.send(reply(request, "Content-Base: " + base + "/\r\nContent-Type: application/sdp\r\n",
                      film.sdp));
    } else if (request.rfind("SETUP", 0) == 0) {
      peer.send(reply(request, "Session: 1\r\nTransport: RTP/AVP/TCP;unicast;interleaved=0-1\r\n"));
    } else if (request.rfind("PLAY", 0) == 0) {
      peer.send(reply(request, "Session: 1\r\n"));
      break;
    } else {
      return;
    }
  }
  for (std::size_t n = 0; n < film.packets.size() && n < silent_after; ++n) {
    for (const std::string& packet : film.packets[n])
      if (!peer.send(interleaved(packet))) return;
    if (!peer.waitForIt(2)) return;
  }
  if (on_silence) on_silence();
  while (peer.waitForIt(1000)) continue;
}

}  // namespace patina::testing
