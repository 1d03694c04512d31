#include "view/web_access.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <array>

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::Optional;

constexpr std::nullopt_t kNoOrigin = std::nullopt;

TEST(WebAccess, OnLoopbackNeedsOneOfItsNames) {
  const WebAccess access = web_access("127.0.0.1", "");
  for (const char* host : {"127.0.0.1:8080", "localhost:8080", "LocalHost", "[::1]:8080", "127.0.0.1:9999"}) {
    EXPECT_EQ(why_refused(access, host, kNoOrigin, ""), std::nullopt) << host;
  }
  for (const char* host : {"evil.example:8080", "evil.example", "", "192.168.0.7:8080", "[::2]:8080", "[::1",
                           "localhost.evil.example", "127.0.0.1.evil.example"}) {
    EXPECT_NE(why_refused(access, host, kNoOrigin, ""), std::nullopt) << host;
  }
}

TEST(WebAccess, RefusesForeignPages) {
  const WebAccess access = web_access("127.0.0.1", "");
  EXPECT_EQ(why_refused(access, "127.0.0.1:8080", "http://127.0.0.1:8080", ""), std::nullopt);
  EXPECT_EQ(why_refused(access, "localhost:8080", "http://localhost:8080", ""), std::nullopt);
  for (const char* origin : {"http://evil.example", "null", "", "http://127.0.0.1:9000", "https://127.0.0.1:8080",
                             "http://localhost:8080", "http://127.0.0.1:8080.evil.example"}) {
    EXPECT_THAT(why_refused(access, "127.0.0.1:8080", origin, ""), Optional(HasSubstr("may not read"))) << origin;
  }
}

TEST(WebAccess, ElsewhereTakesAddressesAndNeedsTheToken) {
  const std::string token = random_token();
  const WebAccess access = web_access("0.0.0.0", token);
  EXPECT_EQ(why_refused(access, "192.168.0.7:8080", "http://192.168.0.7:8080", token), std::nullopt);
  std::array<char, 256> machine{};
  ASSERT_EQ(::gethostname(machine.data(), machine.size() - 1), 0);
  EXPECT_EQ(why_refused(access, std::string(machine.data()) + ".lan:8080", kNoOrigin, token), std::nullopt);
  EXPECT_NE(why_refused(access, "evil.example:8080", "http://evil.example:8080", token), std::nullopt);
  EXPECT_THAT(why_refused(access, "192.168.0.7:8080", kNoOrigin, ""), Optional(HasSubstr("token")));
  EXPECT_THAT(why_refused(access, "192.168.0.7:8080", kNoOrigin, token + "0"), Optional(HasSubstr("token")));
  EXPECT_THAT(why_refused(access, "192.168.0.7:8080", kNoOrigin, token.substr(1) + "g"), Optional(HasSubstr("token")));
}

TEST(WebAccess, KnowsLoopback) {
  for (const char* host : {"127.0.0.1", "127.1.2.3", "localhost", "::1", "[::1]"})
    EXPECT_TRUE(is_loopback(host)) << host;
  for (const char* host : {"0.0.0.0", "192.168.0.7", "::", "example", "127.0.0.1.example"}) {
    EXPECT_FALSE(is_loopback(host)) << host;
  }
}

TEST(WebAccess, TokensDiffer) {
  EXPECT_THAT(random_token(), testing::MatchesRegex("[0-9a-f]+"));
  EXPECT_EQ(random_token().size(), 32U);
  EXPECT_NE(random_token(), random_token());
}

}  // namespace
}  // namespace vesalius
