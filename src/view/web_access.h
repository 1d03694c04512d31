#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// Who may reach a page that shows what a camera sees. A browser sends requests for any page that it has open, so the
/// address of the machine is no protection: a foreign page could ask this server (its Origin tells), or give its own
/// name this server's address (DNS rebinding; the Host tells).
struct WebAccess {
  std::vector<std::string> names;  ///< names by which browsers may call this server, lower case, without port
  bool any_address = false;        ///< whether every numeric address will do as well
  std::string token;               ///< what the address must carry; empty = nothing
};

/// Returns the rules for a server that listens at `host`: on the loopback interface its names alone, elsewhere also
/// this machine's name in any domain, every address, and the token.
WebAccess web_access(const std::string& host, const std::string& token);

/// Returns whether `host`, an address or a name, is this machine talking to itself.
bool is_loopback(const std::string& host);

/// Returns 128 random bits as hexadecimal digits.
std::string random_token();

/// Returns why a request is refused, in a line for the user; nothing if it is not. `host` and `origin` are its headers;
/// only browsers send the latter. `token` is what its address carried.
std::optional<std::string> why_refused(const WebAccess& access, std::string_view host,
                                       std::optional<std::string_view> origin, std::string_view token);

}  // namespace vesalius
