#pragma once

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "vesalius/error.h"

// For tests of what is read from TOML: texts with one fault each, and the errors that name it.
namespace vesalius::test {

/// A fault: a piece of a good text and what stands there instead, and the error's line and words.
struct BadToml {
  const char* old_text;
  const char* new_text;
  int line;
  const char* what;
};

/// Expects that `parse`, which is given a text and its name, refuses the good text with each of the faults.
template <class Parse>
void expect_refused(const std::string& good, const std::vector<BadToml>& faults, const Parse& parse) {
  for (const BadToml& fault : faults) {
    SCOPED_TRACE(fault.new_text);
    std::string text = good;
    const std::size_t at = text.find(fault.old_text);
    ASSERT_NE(at, std::string::npos) << fault.old_text;
    text.replace(at, std::string(fault.old_text).size(), fault.new_text);
    EXPECT_THAT(
        [&] { parse(text, "some.toml"); },
        testing::ThrowsMessage<Error>(testing::AllOf(
            testing::StartsWith("some.toml:" + std::to_string(fault.line) + ":"), testing::HasSubstr(fault.what))));
  }
}

}  // namespace vesalius::test
