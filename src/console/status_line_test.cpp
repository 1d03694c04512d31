#include "console/status_line.h"

#include <gmock/gmock.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <string>

namespace vesalius::cli {
namespace {

/// Makes standard error a terminal of 40 columns while an object of this class lives.
class Terminal {
 public:
  Terminal() : stderr_(::dup(STDERR_FILENO)) {
    winsize size{24, 40, 0, 0};
    EXPECT_EQ(::openpty(&master_, &slave_, nullptr, nullptr, &size), 0);
    ::dup2(slave_, STDERR_FILENO);
  }
  ~Terminal() {
    ::dup2(stderr_, STDERR_FILENO);
    for (const int file : {stderr_, slave_, master_}) ::close(file);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Returns what was written since the last call, and fails if nothing was.
  std::string written() const {
    std::array<char, 4096> bytes{};
    const ssize_t count = ::read(master_, bytes.data(), bytes.size());
    return {bytes.data(), count > 0 ? static_cast<std::size_t>(count) : 0};
  }

 private:
  int stderr_, master_ = -1, slave_ = -1;
};

TEST(StatusLine, IsCutToTheWidthOfTheTerminal) {
  const Terminal terminal;
  StatusLine line(true);
  line.show(std::string(100, 'x'));
  EXPECT_EQ(terminal.written(), std::string(39, 'x'));
  line.clear();
  EXPECT_EQ(terminal.written(), "\r" + std::string(39, ' ') + "\r");
  line.show("short");
  EXPECT_EQ(terminal.written(), "short");
}

}  // namespace
}  // namespace vesalius::cli
