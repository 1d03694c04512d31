#pragma once

#include <cstdint>
#include <string>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/opt.h>
}

namespace vesalius::test {

/// A video's message, and which picture is in it.
struct VideoMessage {
  int picture = 0;
  std::string bytes;
};

/// Returns grey pictures as an encoder of libavcodec packs them, the first of each `group` such that decoding can begin
/// there; nothing where there is no such encoder. Picture i is as bright as `grey_of(i)` says.
inline int grey_of(int picture) { return 40 + 5 * picture; }
inline std::vector<VideoMessage> encode_video(const char* encoder, int width, int height, int pictures, int group,
                                              int between = 0) {
  std::vector<VideoMessage> messages;
  const AVCodec* codec = avcodec_find_encoder_by_name(encoder);
  if (codec == nullptr) return messages;
  AVCodecContext* context = avcodec_alloc_context3(codec);
  context->width = width;
  context->height = height;
  context->time_base = {1, 30};
  context->pix_fmt = AV_PIX_FMT_YUV420P;
  context->gop_size = group;
  context->max_b_frames = between;
  context->thread_count = 1;
  av_opt_set(context->priv_data, "preset", "ultrafast", 0);
  av_opt_set(context->priv_data, "forced-idr", "1", 0);
  if (between == 0) av_opt_set(context->priv_data, "tune", "zerolatency", 0);
  av_opt_set(context->priv_data, "x265-params", "log-level=none", 0);
  av_opt_set(context->priv_data, "x264-params", between > 0 ? "scenecut=0:b-adapt=0" : "scenecut=0", 0);
  AVFrame* frame = av_frame_alloc();
  AVPacket* packet = av_packet_alloc();
  if (avcodec_open2(context, codec, nullptr) == 0) {
    frame->width = width;
    frame->height = height;
    frame->format = context->pix_fmt;
    for (int i = 0; i <= pictures; ++i) {
      if (i < pictures) {
        av_frame_get_buffer(frame, 0);
        for (int plane = 0; plane < 3; ++plane) {
          const int rows = plane == 0 ? height : height / 2;
          const int value = plane == 0 ? grey_of(i) : 128;
          for (int v = 0; v < rows; ++v) {
            for (int u = 0; u < (plane == 0 ? width : width / 2); ++u) {
              frame->data[plane][v * frame->linesize[plane] + u] = static_cast<std::uint8_t>(value);
            }
          }
        }
        frame->pts = i;
        frame->pict_type = i % group == 0 ? AV_PICTURE_TYPE_I : AV_PICTURE_TYPE_NONE;
      }
      avcodec_send_frame(context, i < pictures ? frame : nullptr);
      if (i < pictures) {
        av_frame_unref(frame);
        frame->width = width;
        frame->height = height;
        frame->format = context->pix_fmt;
      }
      while (avcodec_receive_packet(context, packet) == 0) {
        messages.push_back(
            {int(packet->pts), {reinterpret_cast<const char*>(packet->data), std::size_t(packet->size)}});
        av_packet_unref(packet);
      }
    }
  }
  av_packet_free(&packet);
  av_frame_free(&frame);
  avcodec_free_context(&context);
  return messages;
}

}  // namespace vesalius::test
