#pragma once

#include <gmock/gmock.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>

#include "vesalius/base/random.h"
#include "vesalius/error.h"
#include "vesalius/frame.h"

// Helpers that the tests of io share.
namespace vesalius::test {

/// A temporary folder. The destructor removes it with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "vesalius_io_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder: " + pattern);
    root_ = pattern;
    path_ = root_ / "test/files";
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }
  std::size_t file_count() const {
    const std::filesystem::recursive_directory_iterator all(path_);
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
  }

 private:
  std::filesystem::path root_;
  /// Two folders deeper: calibrations are looked for above, and temporary files are everybody's.
  std::filesystem::path path_;
};

/// Writes `bytes` to a file and creates missing folders above it. Returns the path.
inline std::string put(const std::string& path, std::string_view bytes) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

inline std::string get(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns the message of the Error that `f` throws. Fails the test if nothing is thrown or the message has several
/// lines, but for those of what a source holds, which are indented.
inline std::string error_of(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    const std::string_view text = e.what();
    for (auto at = text.find('\n'); at != text.npos; at = text.find('\n', at + 1)) {
      EXPECT_EQ(text.substr(at + 1, 2), "  ") << text;
    }
    return e.what();
  }
  ADD_FAILURE() << "expected an Error";
  return {};
}

/// Returns a frame of random depth, a fifth of it holes, and random colour. No number of its camera is round.
inline Frame random_frame(const std::string& name, std::uint64_t seed, int width = 37, int height = 23,
                          bool colour = true) {
  Random rng(seed);
  Frame frame;
  frame.name = name;
  frame.camera = {width, height, 41.3F, 40.7F, 17.2F, 12.9F};
  frame.depth = DepthImage(width, height);
  for (auto& depth_mm : frame.depth) {
    depth_mm = rng.below(5) == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(400 + rng.below(9000));
  }
  if (colour) {
    frame.colour = ColourImage(width, height);
    const auto byte = [&] { return static_cast<std::uint8_t>(rng.below(256)); };
    for (Rgb& pixel : frame.colour) pixel = {byte(), byte(), byte()};
  }
  return frame;
}

}  // namespace vesalius::test
