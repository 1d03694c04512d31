#include <cstddef>
#include <cstdint>
#include <exception>

#include "io/model/text_trees.h"
#include "vesalius/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vesalius::Forest forest;
  forest.body = vesalius::paper_body();
  try {
    forest.trees = {vesalius::parse_text_tree({reinterpret_cast<const char*>(data), size}, "fuzz")};
  } catch (const vesalius::Error&) {
    return 0;
  }
  for (vesalius::TreeLeaf& leaf : forest.trees[0].leaves)
    leaf.label[0] = 0;  // the text format does not know the body's labels
  try {
    vesalius::check(forest);
  } catch (const vesalius::Error&) {
    std::terminate();  // an accepted tree must be valid
  }
  return 0;
}
