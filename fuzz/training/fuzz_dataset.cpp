#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>

#include "dataset/dataset_shard.h"
#include "dataset/labelled_dataset.h"
#include "dataset/labelled_frame_codec.h"
#include "vesalius/error.h"

namespace {

constexpr int kParts = 25;

void read_frame(const std::string& bytes) {
  vesalius::DatasetFrame frame;
  try {
    frame = vesalius::decode_frame(bytes, kParts, "fuzz");
  } catch (const vesalius::Error&) {
    return;
  }
  try {
    vesalius::encode_frame(frame, kParts);
  } catch (const vesalius::Error&) {
    std::terminate();  // accepted bytes must be a valid frame
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  read_frame(bytes);
  try {
    vesalius::parse_shard_table(bytes, size, "fuzz");
  } catch (const vesalius::Error&) {
  }
  try {
    vesalius::parse_description(bytes, "fuzz");
  } catch (const vesalius::Error&) {
  }
  return 0;
}
