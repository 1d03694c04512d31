#include "io/net/udp_sender.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <sys/socket.h>

#include <string>

#include "vesalius/error.h"

namespace vesalius {
namespace {

TEST(UdpSender, SendsToWhoeverListens) {
  const Descriptor listener(::socket(AF_INET, SOCK_DGRAM, 0));
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(place);
  ASSERT_EQ(::bind(listener.get(), reinterpret_cast<sockaddr*>(&place), size), 0);
  ASSERT_EQ(::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&place), &size), 0);
  const timeval patience{5, 0};
  ::setsockopt(listener.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  UdpSender sender("127.0.0.1:" + std::to_string(ntohs(place.sin_port)));
  for (const std::string& sent : {std::string("hello"), std::string(60000, 'x')}) {
    sender.send(sent);
    std::string received(70000, '\0');
    const ssize_t got = ::recv(listener.get(), received.data(), received.size(), 0);
    ASSERT_GE(got, 0);
    received.resize(static_cast<std::size_t>(got));
    EXPECT_EQ(received, sent);
  }
  EXPECT_THROW(sender.send(std::string(UdpSender::kMost + 1, 'x')), Error);
}

TEST(UdpSender, DoesNotMindThatNobodyListens) {
  UdpSender sender("127.0.0.1:9");
  for (int i = 0; i < 5; ++i) EXPECT_NO_THROW(sender.send("hello"));
}

TEST(UdpSender, CountsWhatCannotBeSentAndGoesOn) {
  UdpSender sender("127.0.0.1:9");
  // A network that goes, as far as the socket can tell.
  int shut = 0;
  for (int descriptor = 3; descriptor < 200; ++descriptor) {
    sockaddr_in peer{};
    socklen_t size = sizeof(peer);
    if (::getpeername(descriptor, reinterpret_cast<sockaddr*>(&peer), &size) != 0 || ntohs(peer.sin_port) != 9)
      continue;
    shut += ::shutdown(descriptor, SHUT_WR) == 0 ? 1 : 0;
  }
  ASSERT_EQ(shut, 1);
  for (int i = 0; i < 3; ++i) EXPECT_NO_THROW(sender.send("hello"));
  EXPECT_EQ(sender.lost(), 3);
  EXPECT_THAT(sender.why_lost(), testing::StartsWith("127.0.0.1:9: 3 datagrams lost: "));
}

TEST(UdpSender, RefusesWhatIsNoAddress) {
  for (const char* address : {"", "127.0.0.1", "127.0.0.1:", ":9000", "127.0.0.1:0", "127.0.0.1:65536", "127.0.0.1:9x",
                              "::1:9000", "127.0.0.1:123456789"}) {
    EXPECT_THROW(UdpSender{address}, UsageError) << address;
  }
  EXPECT_THROW(UdpSender{"no.such.host.invalid:9000"}, Error);
}

}  // namespace
}  // namespace vesalius
