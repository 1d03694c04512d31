#include "cli/text_sink.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <system_error>

namespace vesalius::cli {
namespace {

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

}  // namespace

TextSink::TextSink(const std::string& path) : name_(path) {
  if (path == "-") {
    name_ = kStdoutName;
    stream_.reset(stdout);
    return;
  }
  if (!written_directly(path)) temporary_.emplace(path);
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

std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return text;
}

void say(std::string text) { std::fputs((one_line(std::move(text)) + "\n").c_str(), stderr); }

void finish_stdout() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) fail(kStdoutName);
}

}  // namespace vesalius::cli
