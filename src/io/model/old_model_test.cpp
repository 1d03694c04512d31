#include "io/model/old_model.h"

#include <gmock/gmock.h>

#include "io/files/byte_stream.h"
#include "io/model/model_contents.h"
#include "io/model/model_sections.h"
#include "io/model/test_forest.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"

namespace vesalius {
namespace {

/// Returns a model as version 2 had it.
std::string old_bytes(const Model& model) {
  ByteWriter rest, forest, out;
  rest.text(model.body.toml);
  rest.text(model.forest.recipe);
  write_forest(forest, model.forest);
  const unsigned forest_flags = static_cast<unsigned char>(forest.bytes()[0]);
  rest.bytes() += forest.bytes().substr(2);
  write_headings(rest, model.headings);
  write_boosted(rest, model.context);
  write_boosted(rest, model.judge);
  out.bytes() += serialise_model(model).substr(0, 8);
  out.number(std::uint16_t{2});
  out.number(static_cast<std::uint16_t>(forest_flags | 4U | 8U | 16U));
  out.number(static_cast<std::uint64_t>(28 + rest.bytes().size()));
  ByteWriter checksum;
  checksum.number(xxh64(out.bytes() + rest.bytes()));
  return out.bytes() + checksum.bytes() + rest.bytes();
}

class OldModel : public testing::Test {
 protected:
  void SetUp() override {
    Random random(9, 0);
    Forest forest = test::tiny_forest();
    test::add_logits(forest, 8, random);
    model = forest;
    test::add_judge(model, 2, random);
    model.context = model.judge;
    model.context.bias = -1.F;
    bytes = old_bytes(model);
  }

  Model model;
  std::string bytes;
};

TEST_F(OldModel, IsReadWhole) { EXPECT_EQ(serialise_model(parse_old_model(bytes, "m")), serialise_model(model)); }

TEST_F(OldModel, IsRefusedWithAChangedByteOrCutOff) {
  for (std::size_t n = 12; n < bytes.size(); ++n) {
    std::string changed = bytes;
    changed[n] = static_cast<char>(changed[n] ^ 0x10);
    EXPECT_THROW(parse_old_model(changed, "m"), Error) << n;
    EXPECT_THROW(parse_old_model(bytes.substr(0, n), "m"), Error) << n;
  }
}

}  // namespace
}  // namespace vesalius
