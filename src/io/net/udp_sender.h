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

  /// Sends one datagram. What the network does not take at once is dropped, as a datagram may be on its way. So is what
  /// cannot be sent at all, since the network may come back: that is counted. Throws Error if it is too large.
  void send(std::string_view bytes);

  /// Returns how many datagrams could not be sent at all, and a line that says so with the last reason.
  int lost() const { return lost_; }
  std::string why_lost() const;

 private:
  std::string address_;
  int lost_ = 0;
  int error_ = 0;  ///< errno of the last that was lost
  Descriptor socket_;
};

}  // namespace vesalius
