#include "cluster/message.h"

#include <openssl/evp.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "io/files/packed.h"

namespace vesalius {
namespace {

constexpr std::uint32_t kMagic = 0x534D5356;  // "VSMS"
constexpr std::uint16_t kVersion = 2;
constexpr int kLevel = 1;  ///< of compression: messages are written and read once
constexpr std::size_t kLargest = std::size_t{1} << 32U;

std::string in_base64(const std::string& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');
  const int size = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                   reinterpret_cast<const unsigned char*>(bytes.data()), int(bytes.size()));
  text.resize(size);
  return text;
}

std::string from_base64(std::string_view text, const std::string& name) {
  std::string bytes(3 * (text.size() / 4) + 3, '\0');
  const int size = text.size() % 4 != 0 || text.empty()
                       ? -1
                       : EVP_DecodeBlock(reinterpret_cast<unsigned char*>(bytes.data()),
                                         reinterpret_cast<const unsigned char*>(text.data()), int(text.size()));
  if (size < 0) throw Error(name + ": damaged, expected base 64 after the tab");
  bytes.resize(size - (text.ends_with("==") ? 2 : text.ends_with('=') ? 1 : 0));
  return bytes;
}

}  // namespace

std::string sealed(std::string_view message) {
  const std::string packed = pack(message, kLevel);
  ByteWriter out;
  out.number(kMagic);
  out.number(kVersion);
  out.number(static_cast<std::uint64_t>(XXH64(packed.data(), packed.size(), 0)));
  out.bytes() += packed;
  return std::move(out.bytes());
}

std::string opened(std::string_view envelope, const std::string& name) {
  ByteReader in(envelope, name);
  if (in.number<std::uint32_t>("the mark of a message") != kMagic) throw Error(name + ": no message of vesalius");
  const auto version = in.number<std::uint16_t>("version");
  if (version != kVersion) {
    throw Error(fmt::format("{}: message of version {}, expected {}: the machines have different versions of vesalius",
                            name, version, kVersion));
  }
  const auto expected = in.number<std::uint64_t>("checksum");
  const std::string_view rest = envelope.substr(envelope.size() - in.left());
  if (XXH64(rest.data(), rest.size(), 0) != expected) throw Error(name + ": damaged, its checksum does not match");
  std::string message = read_packed(in, 0, kLargest, "message");
  in.expect_end();
  return message;
}

std::string record_line(const Record& record) { return record.key + '\t' + in_base64(sealed(record.message)) + '\n'; }

Record parse_record(std::string_view line, const std::string& name) {
  if (line.ends_with('\n')) line.remove_suffix(1);
  const std::size_t tab = line.find('\t');
  if (tab == std::string_view::npos || tab == 0) throw Error(name + ": expected a key, a tab and a message");
  Record record{std::string(line.substr(0, tab)), {}};
  const std::string where = name + ": " + record.key;
  record.message = opened(from_base64(line.substr(tab + 1), where), where);
  return record;
}

std::string program_build() { return fmt::format("vesalius {} by {}", VESALIUS_VERSION, __VERSION__); }

void expect_this_build(const std::string& build, const std::string& name) {
  if (build == program_build()) return;
  throw Error(fmt::format("{}: made by {}, this machine has {}; expected the same on all machines", name, build,
                          program_build()));
}

}  // namespace vesalius
