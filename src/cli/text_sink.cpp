#include "cli/text_sink.h"

#include <fmt/format.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace vesalius::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStdoutName = "standard output";

[[noreturn]] void fail(const std::string& name) {
  const int error = errno;
  const std::string message = fmt::format("{}: cannot be written: {}", name, std::generic_category().message(error));
  if (error == EPIPE) throw BrokenPipe(message);
  throw Error(message);
}

void write(std::FILE* stream, std::string_view text, const std::string& name) {
  if (std::fwrite(text.data(), 1, text.size(), stream) != text.size()) fail(name);
}

/// Devices and pipes, and what the shell opened, cannot be replaced by a new file.
bool written_as_it_comes(const std::string& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return path.starts_with("/dev/") || (fs::exists(status) && !fs::is_regular_file(status));
}

}  // namespace

TextSink::TextSink(const std::string& path) : name_(path) {
  if (path == "-") {
    name_ = kStdoutName;
    stream_.reset(stdout);
    return;
  }
  if (!written_as_it_comes(path)) temporary_.emplace(path);
  stream_.reset(std::fopen((temporary_ ? temporary_->path() : path).c_str(), "wb"));
  if (!stream_) fail(name_);
}

void TextSink::line(std::string_view text) {
  write(stream_.get(), text, name_);
  write(stream_.get(), "\n", name_);
  // A reader at the other end of a pipe waits for this frame, not for the buffer to fill.
  if (!temporary_ && std::fflush(stream_.get()) != 0) fail(name_);
}

void TextSink::finish() {
  std::FILE* stream = stream_.release();
  if ((stream == stdout ? std::fflush(stream) : std::fclose(stream)) != 0) fail(name_);
  if (temporary_) temporary_->commit();
}

void print(std::string_view text) { write(stdout, text, kStdoutName); }

void finish_stdout() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) fail(kStdoutName);
}

}  // namespace vesalius::cli
