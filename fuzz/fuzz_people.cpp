#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "export/moving_skeleton.h"
#include "export/people_record.h"
#include "export/write_gltf.h"
#include "export/write_people.h"
#include "vesalius/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto record = vesalius::parse_people({reinterpret_cast<const char*>(data), size}, "fuzz.jsonl", {});
    for (std::size_t set = 0; set < record.sets.size(); ++set) {
      vesalius::to_csv(record, set);
      vesalius::to_coco(record, set);
      for (const int person : vesalius::people_in(record)) vesalius::to_trc(record, set, person, "fuzz.trc");
    }
    const auto skeletons = vesalius::moving_skeletons(record, std::nullopt);
    for (const auto& skeleton : skeletons) vesalius::to_bvh(skeleton);
    vesalius::to_glb(skeletons);
    vesalius::to_k4abt(record, "fuzz.jsonl");
  } catch (const vesalius::Error&) {
  }
  return 0;
}
