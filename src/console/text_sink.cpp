#include "console/text_sink.h"

#include <fmt/format.h>

#include <algorithm>
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

/// Returns the number of bytes of the control character at the beginning of `text`, or 0 if there is none. Control
/// characters are those of ASCII, those of UTF-8 (U+0080 to U+009F), and single bytes that are not UTF-8 but that some
/// terminals take for the latter.
std::size_t control_at(std::string_view text, bool continues) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  if (byte(0) < 0x20 || byte(0) == 0x7f) return 1;
  if (byte(0) == 0xc2 && byte(1) >= 0x80 && byte(1) < 0xa0) return 2;
  return byte(0) >= 0x80 && byte(0) < 0xa0 && !continues ? 1 : 0;
}

template <class Replace>
std::string replace_controls(std::string_view text, Replace&& replace) {
  std::string out;
  std::size_t follow = 0;  // remaining bytes of the current character
  while (!text.empty()) {
    const std::size_t size = control_at(text, follow > 0);
    const auto first = static_cast<unsigned char>(text.front());
    if (size > 0) {
      out += replace(text.substr(0, size));
    } else {
      out += text.front();
    }
    follow = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : first >= 0xc0 ? 1 : follow - std::min<std::size_t>(follow, 1);
    if (size > 0) follow = 0;
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  return out;
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
  // A reader at the other end of a pipe should get this frame now and not when the buffer is full.
  if (!temporary_ && std::fflush(stream_.get()) != 0) fail(name_);
}

void TextSink::finish() {
  if (std::ferror(stream_.get()) != 0) throw Error(name_ + ": cannot be written");  // earlier text was lost
  std::FILE* stream = stream_.release();
  if ((stream == stdout ? std::fflush(stream) : std::fclose(stream)) != 0) fail(name_);
  if (temporary_) temporary_->commit();
}

void print(std::string_view text) { write(stdout, text, kStdoutName); }

std::string one_line(std::string_view text) {
  return replace_controls(text, [](std::string_view) { return " "; });
}

std::string escaped(std::string_view text) {
  return replace_controls(text, [](std::string_view control) {
    if (control == "\n") return std::string(control);
    std::string codes;
    for (const unsigned char c : control) codes += fmt::format("\\x{:02x}", c);
    return codes;
  });
}

void say(std::string_view text) { std::fputs((one_line(text) + "\n").c_str(), stderr); }

void finish_stdout() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) fail(kStdoutName);
}

}  // namespace vesalius::cli
