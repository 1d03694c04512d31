#include "io/files/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <system_error>

#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_writing(const std::string& path, int error) {
  throw Error(fmt::format("{}: cannot be written: {}", path, std::generic_category().message(error)));
}

/// Follows symbolic links, so that the file behind a link is replaced and the link stays.
std::string behind_links(const std::string& path) {
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  const fs::path target = fs::canonical(path, error);
  return error ? path : target.string();
}

constexpr std::string_view kMark = ".tmp";

/// A temporary file that another process made. It is called NAME.tmpPROCESS-COUNT, then an extension.
struct Leftover {
  std::string name;  ///< final name of the file
  pid_t process = 0;
};

std::optional<Leftover> parse_leftover(const std::string& file) {
  const std::size_t mark = file.rfind(kMark);
  if (mark == file.npos || mark == 0) return std::nullopt;
  Leftover leftover{file.substr(0, mark), 0};
  const char* end = file.data() + file.size();
  const auto [dash, error] = std::from_chars(file.data() + mark + kMark.size(), end, leftover.process);
  unsigned count = 0;
  if (error != std::errc() || leftover.process <= 0 || dash == end || *dash != '-') return std::nullopt;
  const auto [stop, count_error] = std::from_chars(dash + 1, end, count);
  if (count_error != std::errc() || (stop != end && *stop != '.')) return std::nullopt;
  return leftover;
}

/// Returns whether nobody writes the file any more. Its process must have ended here, and, since other containers have
/// process numbers of their own, nobody may hold its lock.
bool is_abandoned(const fs::path& path, pid_t process) {
  // A file with this process's number was made by an older process of that number, or it is locked.
  if (process != ::getpid() && (::kill(process, 0) == 0 || errno != ESRCH)) return false;
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW));
  struct stat info {};
  const bool ours = file.is_open() && ::fstat(file.get(), &info) == 0 && S_ISREG(info.st_mode);
  return ours && ::flock(file.get(), LOCK_EX | LOCK_NB) == 0;
}

/// Removes temporary files that killed processes left for files called `name`. Each folder is listed only once in the
/// life of this process, however many files are written there.
void remove_leftovers(const fs::path& folder, const std::string& name) {
  static std::map<fs::path, std::multimap<std::string, fs::path>> abandoned;  // by folder, then by name
  const auto [entry, is_new] = abandoned.try_emplace(folder);
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; is_new && !error && it != end; it.increment(error)) {
    const auto leftover = parse_leftover(it->path().filename().string());
    if (leftover && is_abandoned(it->path(), leftover->process)) entry->second.emplace(leftover->name, it->path());
  }
  const auto [first, last] = entry->second.equal_range(name);
  for (auto it = first; it != last; ++it) fs::remove(it->second, error);
  entry->second.erase(first, last);
}

}  // namespace

bool written_directly(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  const bool inherited = path == "/dev/stdout" || path == "/dev/stderr" || path.starts_with("/dev/fd/");
  return inherited || (fs::exists(status) && !fs::is_regular_file(status));
}

TemporaryFile::TemporaryFile(std::string final_path, const std::string& extension)
    : final_path_(std::move(final_path)) {
  static unsigned counter = 0;
  static std::mutex mutex;  // held until this file is locked, so that no other thread takes it for a leftover
  const std::scoped_lock lock(mutex);
  const fs::path target = behind_links(final_path_);
  remove_leftovers(target.has_parent_path() ? target.parent_path() : ".", target.filename().string());
  path_ = fmt::format("{}{}{}-{}{}", target.string(), kMark, ::getpid(), counter++, extension);
  descriptor_ = Descriptor(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!descriptor_.is_open()) fail_writing(final_path_, errno);
  ::flock(descriptor_.get(), LOCK_EX | LOCK_NB);  // failure is ignored: some file systems have no locks
}

TemporaryFile::~TemporaryFile() {
  if (!committed_) std::remove(path_.c_str());
}

void TemporaryFile::commit() {
  // Some file systems report a full disk only here.
  if (const int error = descriptor_.close()) fail_writing(final_path_, error);
  if (std::rename(path_.c_str(), behind_links(final_path_).c_str()) != 0) fail_writing(final_path_, errno);
  committed_ = true;
}

void write_file_atomically(const std::string& path, std::string_view bytes) {
  if (written_directly(path)) {
    Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    if (!file.is_open()) fail_writing(path, errno);
    if (const int error = write_all(file, bytes)) fail_writing(path, error);
    if (const int error = file.close()) fail_writing(path, error);
    return;
  }
  TemporaryFile file(path);
  if (const int error = write_all(file.descriptor(), bytes)) fail_writing(path, error);
  file.commit();
}

void check_writable(const std::string& path) {
  if (!written_directly(path)) {
    const TemporaryFile probe(path);
    return;
  }
  // A pipe is not opened: whoever reads from it would see it closed again.
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) fail_writing(path, EISDIR);
  if (::access(path.c_str(), W_OK) != 0) fail_writing(path, errno);
}

}  // namespace vesalius
