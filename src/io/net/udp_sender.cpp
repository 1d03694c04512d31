#include "io/net/udp_sender.h"

#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "vesalius/error.h"

namespace vesalius {
namespace {

std::pair<std::string, std::string> host_and_port(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  std::string host = address.substr(0, colon == std::string::npos ? 0 : colon);
  const std::string port = colon == std::string::npos ? "" : address.substr(colon + 1);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  const bool number = !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  const bool one_host = !host.empty() && (address.starts_with('[') || host.find(':') == std::string::npos);
  if (!number || std::stoi(port) < 1 || std::stoi(port) > 65535 || !one_host) {
    throw UsageError(fmt::format("{}: expected HOST:PORT, such as 127.0.0.1:9000", address));
  }
  return {host, port};
}

}  // namespace

UdpSender::UdpSender(const std::string& address) : address_(address) {
  const auto [host, port] = host_and_port(address);
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  const int result = ::getaddrinfo(host.c_str(), port.c_str(), &hints, &found);
  if (result != 0) throw Error(fmt::format("{}: {}", address, ::gai_strerror(result)));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owned(found, ::freeaddrinfo);
  for (const addrinfo* one = found; one != nullptr; one = one->ai_next) {
    socket_ = Descriptor(::socket(one->ai_family, one->ai_socktype | SOCK_CLOEXEC, one->ai_protocol));
    if (socket_.get() < 0) continue;
    if (::connect(socket_.get(), one->ai_addr, one->ai_addrlen) == 0) return;
  }
  throw Error(fmt::format("{}: cannot be sent to: {}", address, std::strerror(errno)));
}

void UdpSender::send(std::string_view bytes) {
  if (bytes.size() > kMost) {
    throw Error(fmt::format("{}: a datagram of {} bytes, expected at most {}", address_, bytes.size(), kMost));
  }
  if (::send(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL) >= 0) return;
  // Nobody listens, or the way is full: what comes next may arrive.
  if (errno == ECONNREFUSED || errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS) return;
  ++lost_;
  error_ = errno;
}

std::string UdpSender::why_lost() const {
  return fmt::format("{}: {} datagrams lost: {}", address_, lost_, std::strerror(error_));
}

}  // namespace vesalius
