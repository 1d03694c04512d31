#include <algorithm>
#include <cstdint>
#include <string>

#include "io/files/packed.h"
#include "io/model/model_sections.h"
#include "io/model/model_trees.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"

namespace {

/// Corrects checksums. A fuzzer cannot guess them and would not get past the table.
std::string with_fitting_checksums(const std::string& bytes) {
  return vesalius::join_sections(vesalius::split_sections(bytes, "fuzz", false));
}

template <class Work>
void try_to(const Work& work) {
  try {
    work();
  } catch (const vesalius::Error&) {
  }
}

/// Returns a tree whose sizes and columns come from the input. The columns are compressed here because a fuzzer cannot
/// guess a zstd frame either.
std::string packed_tree(std::string_view input) {
  vesalius::ByteWriter out, columns;
  const auto byte = [&] {
    const std::uint8_t value = input.empty() ? 0 : static_cast<std::uint8_t>(input.front());
    input.remove_prefix(std::min<std::size_t>(1, input.size()));
    return value;
  };
  out.number(std::uint32_t{1});
  out.number(std::uint32_t{byte()});
  out.number(std::uint32_t{byte()});
  while (!input.empty()) {
    const std::size_t asked = byte();
    const std::size_t size = std::min(asked, input.size());
    columns.bytes() += vesalius::pack(input.substr(0, size), 1);
    input.remove_prefix(size);
  }
  out.text(columns.bytes());
  return out.bytes();
}

void read_and_write_trees(const std::string& bytes) {
  const std::string name = "fuzz";
  vesalius::ByteReader in(bytes, name);
  vesalius::Forest forest;
  forest.body = vesalius::paper_body();
  forest.trees = vesalius::read_trees(in);
  check(forest);
  vesalius::serialise_model(forest);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try_to([&] { vesalius::serialise_model(vesalius::parse_model(bytes, "fuzz")); });
  try_to([&] { vesalius::serialise_model(vesalius::parse_model(with_fitting_checksums(bytes), "fuzz")); });
  try_to([&] { read_and_write_trees(packed_tree(bytes)); });
  return 0;
}
