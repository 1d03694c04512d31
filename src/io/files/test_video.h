#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "vesalius/image.h"

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

/// How bright a picture is.
inline int grey_of(int picture) { return 40 + 5 * picture; }
inline AVFrame* grey_picture(const AVCodecContext& of, int picture) {
  AVFrame* frame = av_frame_alloc();
  frame->width = of.width;
  frame->height = of.height;
  frame->format = of.pix_fmt;
  frame->pts = picture;
  frame->pict_type = picture % of.gop_size == 0 ? AV_PICTURE_TYPE_I : AV_PICTURE_TYPE_NONE;
  av_frame_get_buffer(frame, 0);
  for (int plane = 0; plane < 3; ++plane) {
    const int rows = plane == 0 ? of.height : of.height / 2;
    std::memset(frame->data[plane], plane == 0 ? grey_of(picture) : 128,
                std::size_t(rows) * std::size_t(frame->linesize[plane]));
  }
  return frame;
}

/// Returns grey pictures as an encoder of libavcodec packs them, the first of each `group` such that decoding can begin
/// there; nothing where there is no such encoder.
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
  AVPacket* packet = av_packet_alloc();
  const bool is_open = avcodec_open2(context, codec, nullptr) == 0;
  for (int i = 0; is_open && i <= pictures; ++i) {
    AVFrame* frame = i < pictures ? grey_picture(*context, i) : nullptr;
    avcodec_send_frame(context, frame);
    av_frame_free(&frame);
    while (avcodec_receive_packet(context, packet) == 0) {
      messages.push_back({int(packet->pts), {reinterpret_cast<const char*>(packet->data), std::size_t(packet->size)}});
      av_packet_unref(packet);
    }
  }
  av_packet_free(&packet);
  avcodec_free_context(&context);
  return messages;
}

/// Returns a picture of floats as OpenEXR; nothing where there is no encoder.
inline std::string encode_exr(const Image<float>& image) {
  const AVCodec* codec = avcodec_find_encoder_by_name("exr");
  if (codec == nullptr) return {};
  AVCodecContext* context = avcodec_alloc_context3(codec);
  context->width = image.width();
  context->height = image.height();
  context->time_base = {1, 1};
  context->pix_fmt = AV_PIX_FMT_GRAYF32;
  AVFrame* frame = av_frame_alloc();
  frame->width = context->width;
  frame->height = context->height;
  frame->format = context->pix_fmt;
  AVPacket* packet = av_packet_alloc();
  std::string bytes;
  if (avcodec_open2(context, codec, nullptr) == 0 && av_frame_get_buffer(frame, 0) == 0) {
    for (int v = 0; v < image.height(); ++v) {
      std::memcpy(frame->data[0] + std::ptrdiff_t{frame->linesize[0]} * v, image.row(v),
                  sizeof(float) * std::size_t(image.width()));
    }
    avcodec_send_frame(context, frame);
    if (avcodec_receive_packet(context, packet) == 0) {
      bytes.assign(reinterpret_cast<const char*>(packet->data), std::size_t(packet->size));
    }
  }
  av_packet_free(&packet);
  av_frame_free(&frame);
  avcodec_free_context(&context);
  return bytes;
}

}  // namespace vesalius::test
