#pragma once

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "io/files/atomic_file.h"
#include "vesalius/error.h"

namespace vesalius::cli {

/// This error says that the reader of the program's output has closed it.
class BrokenPipe : public Error {
 public:
  using Error::Error;
};

/// Writes lines of text to standard output ("-"), to a device or pipe (line by line), or to a file (which appears at
/// `finish`). All members throw Error with the path and the system's reason, and BrokenPipe if the reader has closed
/// the output.
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
  // The file is declared before the stream, so that it is removed after the stream is closed.
  std::optional<TemporaryFile> temporary_;
  std::unique_ptr<std::FILE, Close> stream_;
};

/// Writes to standard output. Throws as TextSink does.
void print(std::string_view text);

/// Writes a line to standard error with control characters as spaces. Failures are ignored, since they could not be
/// reported anywhere.
void say(std::string_view text);

/// Returns `text` as one line that is safe on a terminal: control characters, including those of UTF-8, become spaces.
std::string one_line(std::string_view text);

/// Returns `text` with control characters other than line ends written as "\x1b", so that text from files cannot
/// command the terminal.
std::string escaped(std::string_view text);

/// Throws if not all printed text could be written.
void finish_stdout();

}  // namespace vesalius::cli
