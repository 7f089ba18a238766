#include "transport/address.hpp"

#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

TEST(Address, ReadsNamesNumbersAndBrackets) {
  EXPECT_EQ(parse_address("pc.lab:5000", "link.peer").host, "pc.lab");
  EXPECT_EQ(parse_address("10.0.0.2:0", "link.peer").port, "0");
  EXPECT_EQ(parse_address("[fe80::1%eth0]:65535", "link.peer").host, "fe80::1%eth0");
}

TEST(Address, NamesTheKeyAndTheTextThatItRefuses) {
  for (const char* text : {"", "host", "host:", ":5000", "[]:5000", "::1:5000", "[::1:5000",
                           "host:65536", "host:-1", "host:5000x", "host:http"}) {
    try {
      static_cast<void>(parse_address(text, "link.peer"));
      FAIL() << text;
    } catch (const TransportError& error) {
      const std::string what = error.what();
      EXPECT_NE(what.find("link.peer = \"" + std::string{text} + "\""), std::string::npos) << what;
      EXPECT_EQ(what.find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace teleop
