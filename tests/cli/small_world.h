#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "vesalius/forest.h"

namespace vesalius {

/// A folder with frames of a rendered person (a, b) and of an empty room (c), and a forest trained on them. It is made
/// once for all tests of a process and removed after them.
class SmallWorld : public testing::Test {
 public:
  static void SetUpTestSuite();
  static void TearDownTestSuite();

 protected:
  static std::string path(const std::string& name) { return (folder() / name).string(); }
  static std::string frames() { return path("frames"); }
  static std::string model() { return path("m.forest"); }
  static void write(const std::string& name, const std::string& bytes);

 private:
  static std::filesystem::path folder();
};

}  // namespace vesalius
