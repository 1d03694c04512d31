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

/// Lines of text for standard output ("-"), a device or pipe (written as it comes), or a file (which appears whole, at
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
void say(std::string text);

/// `text` as one line for a terminal: control characters become spaces.
std::string one_line(std::string text);

/// Throws when not all that was printed arrived.
void finish_stdout();

}  // namespace vesalius::cli
