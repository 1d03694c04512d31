#include "io/recordings/unpacked_file.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>
#include <zstd.h>

#include <cerrno>
#include <filesystem>
#include <memory>
#include <system_error>

#include "io/recordings/chunked_recording.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

[[noreturn]] void fail_unpacking_file(const std::string& path, const std::string& why) {
  throw Error(fmt::format("{}: cannot be unpacked: {}", path, why));
}

/// Returns a file in TMPDIR that has no name any more.
Descriptor temporary_file(const std::string& for_path) {
  std::error_code none;
  std::string path = (std::filesystem::temp_directory_path(none) / "vesalius_XXXXXX").string();
  Descriptor file(::mkstemp(path.data()));
  if (!file.is_open()) fail_unpacking_file(for_path, path + ": " + std::generic_category().message(errno));
  ::unlink(path.c_str());
  return file;
}

}  // namespace

DataFile unpack_file(const DataFile& packed) {
  const std::string& path = packed.path();
  OpenFile to{temporary_file(path)};
  UnpackedBytes unpacked(packed.size());
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(), ZSTD_freeDStream);
  std::string out(ZSTD_DStreamOutSize(), '\0');
  for (std::uint64_t at = 0; at < packed.size(); at += ZSTD_DStreamInSize()) {
    const std::string bytes = packed.read(at, ZSTD_DStreamInSize());
    ZSTD_inBuffer from{bytes.data(), bytes.size(), 0};
    ZSTD_outBuffer piece{};
    do {  // until all is taken, and all that came of it is out
      piece = {out.data(), out.size(), 0};
      if (ZSTD_isError(ZSTD_decompressStream(stream.get(), &piece, &from)) != 0)
        fail_unpacking_file(path, "damaged zstd");
      unpacked.add(piece.pos, path);
      to.size += piece.pos;
      const int error = write_all(to.descriptor, std::string_view(out).substr(0, piece.pos));
      if (error != 0) fail_unpacking_file(path, std::generic_category().message(error) + " (in TMPDIR)");
    } while (from.pos < from.size || piece.pos == piece.size);
  }
  if (to.size == 0) fail_unpacking_file(path, "cut short before anything came of it");
  return {path, std::move(to)};
}

}  // namespace vesalius
