#include "io/files/packed.h"

#include <zstd.h>

#include <memory>

namespace vesalius {
namespace {

constexpr int kQuickLevel = 3;

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

std::size_t compress(std::string& packed, std::string_view raw, int level) {
  // At high levels a compression context holds 100 MB, so only the fast levels, which are used for every frame, keep
  // theirs.
  if (level > kQuickLevel) return ZSTD_compress(packed.data(), packed.size(), raw.data(), raw.size(), level);
  thread_local const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  return ZSTD_compressCCtx(context.get(), packed.data(), packed.size(), raw.data(), raw.size(), level);
}

}  // namespace

std::string pack(std::string_view raw, int level) {
  std::string packed(ZSTD_compressBound(raw.size()), '\0');
  const std::size_t size = compress(packed, raw, level);
  if (ZSTD_isError(size)) throw Error(fmt::format("zstd: {}", ZSTD_getErrorName(size)));
  packed.resize(size);
  ByteWriter out;
  out.number(static_cast<std::uint32_t>(raw.size()));
  out.text(packed);
  return std::move(out.bytes());
}

std::string read_packed(ByteReader& in, std::size_t smallest, std::size_t largest, const char* what) {
  const auto size = in.number<std::uint32_t>(what);
  if (size < smallest || size > largest) {
    in.fail(fmt::format("{}: {} bytes, expected {} to {}", what, size, smallest, largest));
  }
  const std::string_view packed = in.text(what);
  thread_local const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
  std::string raw(size, '\0');
  const std::size_t got = ZSTD_decompressDCtx(context.get(), raw.data(), raw.size(), packed.data(), packed.size());
  if (ZSTD_isError(got) || got != size) in.fail(fmt::format("{}: cannot be decompressed", what));
  return raw;
}

}  // namespace vesalius
