#include "downloads/unpack.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 16;
constexpr std::size_t kMaxShown = 80;

using Archive = std::unique_ptr<struct archive, decltype(&archive_read_free)>;

/// Makes text from an untrusted archive fit for a one-line message.
std::string printable(std::string_view text) {
  std::string out(text.substr(0, kMaxShown));
  std::ranges::replace_if(
      out, [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  return out;
}

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {
    if (!archive_) throw Error(path + ": no memory to read the archive");
    archive_read_support_format_tar(archive_.get());
    archive_read_support_filter_all(archive_.get());
    check(archive_read_open_filename(archive_.get(), path.c_str(), kBlock));
  }

  /// Returns the next entry, or null at the end.
  archive_entry* next() {
    archive_entry* entry = nullptr;
    const int result = archive_read_next_header(archive_.get(), &entry);
    if (result == ARCHIVE_EOF) return nullptr;
    check(result);
    return entry;
  }
  void pass_bytes(const UnpackSink& sink) {
    const void* data = nullptr;
    std::size_t size = 0;
    la_int64_t offset = 0;
    la_int64_t expected = 0;
    for (;;) {
      const int result = archive_read_data_block(archive_.get(), &data, &size, &offset);
      if (result == ARCHIVE_EOF) return;
      check(result);
      if (offset != expected) fail("a file with holes, expected whole files");
      sink.bytes({static_cast<const char*>(data), size});
      expected += static_cast<la_int64_t>(size);
    }
  }
  [[noreturn]] void fail(const std::string& what) const { throw Error(fmt::format("{}: {}", path_, what)); }

 private:
  void check(int result) const {
    if (result == ARCHIVE_OK) return;
    const char* reason = archive_error_string(archive_.get());
    fail(fmt::format("cannot be unpacked: {}", printable(reason != nullptr ? reason : "no reason given")));
  }

  const std::string& path_;
  Archive archive_{archive_read_new(), archive_read_free};
};

/// Returns the path of an entry without the "/" at the end of a folder's path and the "./" at the beginning that some
/// archives have.
std::string checked_path(const Reader& reader, archive_entry* entry) {
  const char* raw = archive_entry_pathname(entry);
  if (raw == nullptr) reader.fail("an entry without a readable name");
  std::string_view path(raw);
  if (path == "./") return {};
  if (path.starts_with("./")) path.remove_prefix(2);
  if (path.ends_with('/')) path.remove_suffix(1);
  if (!stays_inside(path)) {
    reader.fail(fmt::format("\"{}\": expected a path inside the archive", printable(raw)));
  }
  return std::string(path);
}

}  // namespace

bool stays_inside(std::string_view path) {
  if (path.empty() || std::ranges::any_of(path, [](unsigned char c) { return c < ' ' || c == 0x7f || c == '\\'; })) {
    return false;
  }
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string_view component = path.substr(begin, end - begin);
    if (component.empty() || component == "." || component == "..") return false;
    begin = end + 1;
  }
  return true;
}

void unpack(const std::string& archive_path, const UnpackSink& sink) {
  Reader reader(archive_path);
  while (archive_entry* entry = reader.next()) {
    const std::string path = checked_path(reader, entry);
    const bool link = archive_entry_hardlink(entry) != nullptr;
    if (!link && archive_entry_filetype(entry) == AE_IFDIR) continue;
    if (link || archive_entry_filetype(entry) != AE_IFREG) {
      reader.fail(fmt::format("\"{}\" is a link or device, expected files and folders", printable(path)));
    }
    if (!sink.begin(path)) continue;
    reader.pass_bytes(sink);
    sink.end();
  }
}

}  // namespace vesalius
