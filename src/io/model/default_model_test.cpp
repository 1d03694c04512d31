#include "io/model/default_model.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "io/files/test_files.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::ElementsAre;
using testing::ThrowsMessage;

TEST(DefaultModel, IsLookedForWhereTheUserSaysAndThenBesideTheBinary) {
  ::setenv("VESALIUS_MODELS", "/mine", 1);
  EXPECT_THAT(model_folders("/opt/lib", "../share/models"),
              ElementsAre("/mine", "/opt/lib/models", "/opt/share/models"));
  EXPECT_THAT(model_folders("", "../share/models"), ElementsAre("/mine"));
  ::unsetenv("VESALIUS_MODELS");
  EXPECT_THAT(model_folders("/opt/lib", "../share/models"), ElementsAre("/opt/lib/models", "/opt/share/models"));
}

TEST(DefaultModel, IsTheFirstThatIsThere) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "second");
  std::ofstream(folder / "second/default.model") << "a model";
  EXPECT_EQ(find_default_model({folder / "first", folder / "second"}, "no model"), folder / "second/default.model");
  EXPECT_THAT(([] {
                find_default_model({"/one", "/two"}, "no model");
              }),
              ThrowsMessage<Error>("no model, and no default.model in /one, /two"));
}

}  // namespace
}  // namespace vesalius
