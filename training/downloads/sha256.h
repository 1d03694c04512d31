#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace vesalius {

/// Computes the SHA-256 (FIPS 180-4) of bytes that are given in pieces.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void update(std::string_view bytes);
  /// Returns the digest as 64 lower-case hexadecimal digits. Bytes that are added afterwards begin a new digest.
  std::string finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns the SHA-256 of bytes.
std::string sha256_of(std::string_view bytes);

/// Returns the SHA-256 of a regular file. Throws Error with the path and the system's reason.
std::string sha256_of_file(const std::string& path);

}  // namespace vesalius
