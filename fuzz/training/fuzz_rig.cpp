#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "synth/body/makehuman_files.h"
#include "synth/body/rig_map.h"
#include "vesalius/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vesalius::synth;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const std::vector<SkeletonBone> bones = parse_skeleton(text, "fuzz.mhskel", 100);
    map_rig(bones, makehuman_rig_map());
  } catch (const vesalius::Error&) {
  }
  try {
    std::vector<SkeletonBone> bones(2);
    bones[0].name = "root";
    bones[1].name = "arm";
    parse_weights(text, "fuzz.mhw", bones, 8, {0, 1, 2});
  } catch (const vesalius::Error&) {
  }
  try {
    parse_rig_map(text, "fuzz.toml");
  } catch (const vesalius::Error&) {
  }
  return 0;
}
