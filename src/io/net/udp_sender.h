#pragma once

#include <string>
#include <string_view>

#include "io/files/descriptor.h"

namespace vesalius {

/// Sends datagrams to one address. Nobody has to listen there.
class UdpSender {
 public:
  /// Largest datagram, bytes.
  static constexpr std::size_t kMost = 65507;

  /// Takes "HOST:PORT" or "[IPV6]:PORT". Throws UsageError for another form and Error if the host is not known.
  explicit UdpSender(const std::string& address);

  /// Sends one datagram. What the network does not take at once is dropped, as a datagram may be on its way. Throws
  /// Error if it is too large or cannot be sent at all.
  void send(std::string_view bytes) const;

 private:
  std::string address_;
  Descriptor socket_;
};

}  // namespace vesalius
