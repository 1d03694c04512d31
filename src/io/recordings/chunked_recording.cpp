#include "io/recordings/chunked_recording.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::size_t kFirstStep = std::size_t{1} << 16;

[[noreturn]] void fail_unpacking(const std::string& name, std::string_view method) {
  throw Error(fmt::format("{}: damaged: its {} data cannot be decompressed", name, method));
}

/// Asks `more` for the next bytes until it has none. It gets room and returns how many bytes it wrote, 0 at the end.
template <class More>
std::string collect(std::size_t size, const std::string& name, std::string_view method, Packed extent,
                    const More& more) {
  std::string out;
  for (;;) {
    const std::size_t had = out.size();
    // One byte more than stated shows that there is more than stated.
    out.resize(std::min(had + std::max(had, kFirstStep), size + 1));
    const std::size_t got = more(out.data() + had, out.size() - had);
    out.resize(had + got);
    if (got == 0) break;
    if (out.size() > size) fail_unpacking(name, method);
  }
  if (extent == Packed::whole && out.size() != size) fail_unpacking(name, method);
  return out;
}

std::string of_zstd(std::string_view packed, std::size_t size, const std::string& name, Packed extent) {
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(), ZSTD_freeDStream);
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  return collect(size, name, "zstd", extent, [&](char* to, std::size_t room) -> std::size_t {
    ZSTD_outBuffer out{to, room, 0};
    while (out.pos == 0) {
      const std::size_t before = in.pos;
      const std::size_t status = ZSTD_decompressStream(stream.get(), &out, &in);
      if (ZSTD_isError(status) != 0) fail_unpacking(name, "zstd");
      if (out.pos == 0 && in.pos == before) return 0;
    }
    return out.pos;
  });
}

std::string of_lz4(std::string_view packed, std::size_t size, const std::string& name, Packed extent) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0) fail_unpacking(name, "lz4");
  const std::unique_ptr<LZ4F_dctx, std::size_t (*)(LZ4F_dctx*)> context(made, LZ4F_freeDecompressionContext);
  std::size_t at = 0;
  return collect(size, name, "lz4", extent, [&](char* to, std::size_t room) -> std::size_t {
    for (;;) {
      std::size_t written = room;
      std::size_t taken = packed.size() - at;
      const std::size_t status = LZ4F_decompress(context.get(), to, &written, packed.data() + at, &taken, nullptr);
      if (LZ4F_isError(status) != 0) fail_unpacking(name, "lz4");
      at += taken;
      if (written > 0 || taken == 0) return written;
    }
  });
}

std::string of_bzip2(std::string_view packed, std::size_t size, const std::string& name, Packed extent) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) fail_unpacking(name, "bzip2");
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> end(&stream, BZ2_bzDecompressEnd);
  stream.next_in = const_cast<char*>(packed.data());  // bzlib reads only
  stream.avail_in = static_cast<unsigned>(packed.size());
  bool ended = false;
  return collect(size, name, "bzip2", extent, [&](char* to, std::size_t room) -> std::size_t {
    if (ended) return 0;
    stream.next_out = to;
    stream.avail_out = static_cast<unsigned>(room);
    const int status = BZ2_bzDecompress(&stream);
    if (status != BZ_OK && status != BZ_STREAM_END) fail_unpacking(name, "bzip2");
    ended = status == BZ_STREAM_END;
    return room - stream.avail_out;
  });
}

}  // namespace

void UnpackedBytes::add(std::uint64_t bytes, const std::string& name) {
  sum_ += bytes;
  if (sum_ <= most_) return;
  throw Error(fmt::format("{}: unpacks to more than {} MiB, expected at most {} times its size", name, most_ >> 20U,
                          kMostTimes));
}

std::string ChunkedRecording::read_piece(std::uint64_t at, std::uint64_t length) const {
  constexpr std::uint64_t kHead = 4096;  // before the piece itself
  if (length > kMaxPieceBytes + kHead) {
    throw Error(fmt::format("{}: a record of {} bytes at byte {}, expected at most {}", file_.path(), length, at,
                            kMaxPieceBytes));
  }
  return file_.read(at, length);
}

void ChunkedRecording::unpack_chunk(std::string_view packed, std::string_view method, std::size_t size, Packed extent) {
  try {
    unpacked_.add(std::min(size, kMaxPieceBytes), file_.path());
  } catch (const Error&) {
    at_ = file_.size();
    throw;
  }
  chunk_ = decompress(packed, method, size, file_.path(), extent);
}

std::string decompress(std::string_view packed, std::string_view method, std::size_t size, const std::string& name,
                       Packed extent) {
  if (size > kMaxPieceBytes || packed.size() > kMaxPieceBytes) {
    throw Error(fmt::format("{}: a piece of {} bytes, expected at most {}", name, std::max(size, packed.size()),
                            kMaxPieceBytes));
  }
  if (method.empty() || method == "none") {
    if (extent == Packed::whole && packed.size() != size) fail_unpacking(name, "stored");
    return std::string(packed.substr(0, size));
  }
  if (method == "zstd") return of_zstd(packed, size, name, extent);
  if (method == "lz4") return of_lz4(packed, size, name, extent);
  if (method == "bz2") return of_bzip2(packed, size, name, extent);
  throw Error(fmt::format("{}: compressed with \"{}\", expected zstd, lz4 or bz2", name, method));
}

std::size_t stated_zstd_size(std::string_view packed, const std::string& name) {
  const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) fail_unpacking(name, "zstd");
  return size;
}

}  // namespace vesalius
