#pragma once

#include <archive.h>
#include <archive_entry.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

// Good and bad archives for tests.
namespace vesalius::test {

inline constexpr unsigned kHardLink = 0;

struct ArchiveEntry {
  std::string path;
  std::string content;       ///< bytes of a file, or target of a link
  unsigned type = AE_IFREG;  ///< AE_IFREG and the like, or kHardLink
};

/// Writes a tar file, compressed as its name says (.tar, .tar.xz, .tar.gz). Returns the path.
inline std::string write_archive(const std::string& path, const std::vector<ArchiveEntry>& entries) {
  const std::unique_ptr<archive, decltype(&archive_write_free)> out(archive_write_new(), archive_write_free);
  const auto check = [&](int result) {
    if (result != ARCHIVE_OK) throw std::runtime_error(path + ": " + archive_error_string(out.get()));
  };
  check(archive_write_set_format_pax_restricted(out.get()));
  if (path.ends_with(".xz")) check(archive_write_add_filter_xz(out.get()));
  if (path.ends_with(".gz")) check(archive_write_add_filter_gzip(out.get()));
  check(archive_write_open_filename(out.get(), path.c_str()));
  for (const ArchiveEntry& wanted : entries) {
    const std::unique_ptr<archive_entry, decltype(&archive_entry_free)> entry(archive_entry_new(), archive_entry_free);
    archive_entry_set_pathname(entry.get(), wanted.path.c_str());
    archive_entry_set_perm(entry.get(), 0644);
    archive_entry_set_filetype(entry.get(), wanted.type == kHardLink ? unsigned{AE_IFREG} : wanted.type);
    if (wanted.type == kHardLink) archive_entry_set_hardlink(entry.get(), wanted.content.c_str());
    if (wanted.type == AE_IFLNK) archive_entry_set_symlink(entry.get(), wanted.content.c_str());
    const bool file = wanted.type == AE_IFREG;
    archive_entry_set_size(entry.get(), file ? static_cast<la_int64_t>(wanted.content.size()) : 0);
    check(archive_write_header(out.get(), entry.get()));
    if (file) archive_write_data(out.get(), wanted.content.data(), wanted.content.size());
  }
  check(archive_write_close(out.get()));
  return path;
}

}  // namespace vesalius::test
