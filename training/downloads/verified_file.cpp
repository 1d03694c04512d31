#include "downloads/verified_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

namespace vesalius {

namespace fs = std::filesystem;

bool holds(const std::string& path, const FileDigest& expected) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || fs::file_size(path, error) != expected.bytes) return false;
  return sha256_of_file(path) == expected.sha256;
}

VerifiedFile::VerifiedFile(std::string path, std::string unfinished_path, FileDigest expected)
    : path_(std::move(path)), unfinished_path_(std::move(unfinished_path)), expected_(std::move(expected)) {
  file_ = Descriptor(::open(unfinished_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (!file_.is_open()) fail(errno);
}

VerifiedFile::~VerifiedFile() {
  if (!committed_) std::remove(unfinished_path_.c_str());
}

void VerifiedFile::fail(int error) const {
  throw Error(fmt::format("{}: cannot be written: {}", path_, std::generic_category().message(error)));
}

void VerifiedFile::write(std::string_view bytes) {
  if (bytes.size() > expected_.bytes - written_) {
    throw WrongBytes(fmt::format("{}: more bytes came than the {} expected", path_, expected_.bytes));
  }
  sum_.update(bytes);
  written_ += bytes.size();
  if (const int error = write_all(file_, bytes)) fail(error);
}

void VerifiedFile::restart() {
  if (::ftruncate(file_.get(), 0) != 0 || ::lseek(file_.get(), 0, SEEK_SET) != 0) fail(errno);
  sum_.finish();
  written_ = 0;
}

void VerifiedFile::commit() {
  if (written_ != expected_.bytes) {
    throw WrongBytes(fmt::format("{}: {} bytes came, expected {}", path_, written_, expected_.bytes));
  }
  const std::string sum = sum_.finish();
  if (sum != expected_.sha256) {
    throw WrongBytes(fmt::format("{}: SHA-256 of what came is {}, expected {}", path_, sum, expected_.sha256));
  }
  // Some file systems report a full disk only here.
  if (const int error = file_.close()) fail(error);
  std::error_code error;
  fs::create_directories(fs::path(path_).parent_path(), error);
  if (error) fail(error.value());
  if (std::rename(unfinished_path_.c_str(), path_.c_str()) != 0) fail(errno);
  committed_ = true;
}

}  // namespace vesalius
