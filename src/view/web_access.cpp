#include "view/web_access.h"

#include <fmt/format.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/ip/address.hpp>

#include "io/files/plain_text.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

/// Removes the port from "name:8080" or "[::1]:8080", and the brackets.
std::string name_in(std::string_view host) {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end == host.npos ? std::string() : lower(host.substr(1, end - 1));
  }
  return lower(host.substr(0, host.find(':')));
}

std::optional<boost::asio::ip::address> address_of(const std::string& name) {
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address(name, error);
  if (error) return std::nullopt;
  return address;
}

/// Takes the same time wherever the two differ, so that nobody finds the token digit by digit.
bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char differences = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differences |= static_cast<unsigned char>(a[i] ^ b[i]);
  return differences == 0;
}

std::string machine_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return {};
  return lower(name.data());
}

}  // namespace

bool is_loopback(const std::string& host) {
  const std::string name =
      name_in(host.find(':') != host.rfind(':') && !host.starts_with('[') ? "[" + host + "]" : host);
  if (name == "localhost") return true;
  const auto address = address_of(name);
  return address && address->is_loopback();
}

WebAccess web_access(const std::string& host, const std::string& token) {
  WebAccess access{{"localhost", "127.0.0.1", "::1", lower(host)}, !is_loopback(host), token};
  if (access.any_address) {
    const std::string machine = machine_name();
    if (!machine.empty()) {
      access.names.push_back(machine);
      access.names.push_back(machine + ".local");
    }
  }
  return access;
}

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw Error("no random bytes from the system, expected 16 for the page's token");
  }
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

std::optional<std::string> why_refused(const WebAccess& access, std::string_view host,
                                       std::optional<std::string_view> origin, std::string_view token) {
  const std::string name = name_in(host);
  const auto is_name = [&](const std::string& own) {
    // "robot.lan" is the machine "robot" in a network of one's own; the token keeps strangers out.
    return name == own || (access.any_address && name.starts_with(own + ".") && own.find('.') == own.npos);
  };
  const bool known = std::ranges::any_of(access.names, is_name);
  if (!known && !(access.any_address && address_of(name))) {
    return fmt::format("this server is not called {}, expected {}", host.empty() ? "nothing" : name,
                       access.names.front());
  }
  if (origin && lower(*origin) != "http://" + lower(host)) {
    return fmt::format("a page of {} may not read this one", *origin);
  }
  if (!access.token.empty() && !same_secret(token, access.token)) {
    return "wrong token, expected the one in the address that vesalius view printed";
  }
  return std::nullopt;
}

}  // namespace vesalius
