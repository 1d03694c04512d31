#pragma once

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "io/files/atomic_file.h"
#include "vesalius/base/error.h"

namespace vesalius::cli {

/// Whoever read the program's output has closed it.
class BrokenPipe : public Error {
 public:
  using Error::Error;
};

/// Lines of text for standard output ("-"), a device or pipe (written as they come), or a file (which appears at
/// `finish`). All members throw Error with the path and the system's reason, BrokenPipe where a reader left.
class TextSink {
 public:
  explicit TextSink(const std::string& path);
  void line(std::string_view text);
  void finish();

 private:
  struct Close {
    void operator()(std::FILE* file) const {
      if (file != stdout) std::fclose(file);
    }
  };

  std::string name_;
  std::optional<TemporaryFile> temporary_;  // before the stream: removed after it is closed
  std::unique_ptr<std::FILE, Close> stream_;
};

/// Writes to standard output; throws like TextSink.
void print(std::string_view text);

/// Writes a line to standard error, control characters as spaces. Where that cannot be written nobody can be told.
void say(std::string_view text);

/// Returns `text` as one line that is safe on a terminal: control characters, those of UTF-8 among them, become spaces.
std::string one_line(std::string_view text);

/// Returns `text` with control characters but line ends as "\x1b": what files say cannot command the terminal.
std::string escaped(std::string_view text);

/// Throws when not all that was printed arrived.
void finish_stdout();

}  // namespace vesalius::cli
