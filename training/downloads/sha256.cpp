#include "downloads/sha256.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <vector>

#include "vesalius/error.h"

namespace vesalius {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 16;

void expect(int success) {
  if (success != 1) throw Error("SHA-256: the system's OpenSSL refuses to compute it");
}

[[noreturn]] void fail(const std::string& path, int error) {
  throw Error(fmt::format("{}: cannot be read: {}", path, std::generic_category().message(error)));
}

}  // namespace

struct Sha256::State {
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context{EVP_MD_CTX_new(), EVP_MD_CTX_free};

  void begin() { expect(context ? EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) : 0); }
};

Sha256::Sha256() : state_(std::make_unique<State>()) { state_->begin(); }
Sha256::~Sha256() = default;

void Sha256::update(std::string_view bytes) {
  expect(EVP_DigestUpdate(state_->context.get(), bytes.data(), bytes.size()));
}

std::string Sha256::finish() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  expect(EVP_DigestFinal_ex(state_->context.get(), digest.data(), &size));
  state_->begin();
  std::string text;
  for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

std::string sha256_of(std::string_view bytes) {
  Sha256 sum;
  sum.update(bytes);
  return sum.finish();
}

std::string sha256_of_file(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw Error(path + ": not a regular file");  // reading a pipe would block
  }
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"), std::fclose);
  if (!file) fail(path, errno);
  Sha256 sum;
  std::vector<char> piece(kPiece);
  for (;;) {
    const std::size_t n = std::fread(piece.data(), 1, piece.size(), file.get());
    sum.update({piece.data(), n});
    if (n < piece.size()) break;
  }
  if (std::ferror(file.get()) != 0) fail(path, errno);
  return sum.finish();
}

}  // namespace vesalius
