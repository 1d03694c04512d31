#include "synth/body/builtin_body.h"

#include <algorithm>
#include <string_view>

namespace vesalius::synth {
namespace {

struct File {
  std::string_view path, text;
};

constexpr File kFiles[] = {
#include "builtin_body.inc"
};

}  // namespace

const MakeHumanModel& builtin_bodies() {
  static const MakeHumanModel bodies = [] {
    MakeHumanModel::Files files{"base.obj", "rig.mhskel", "weights.mhw", {}};
    for (const File& file : kFiles) {
      if (file.path.ends_with(".target")) files.targets.emplace_back(file.path);
    }
    const ReadText read = [](const std::string& path) {
      return std::string(std::ranges::find(kFiles, path, &File::path)->text);
    };
    return MakeHumanModel(read, files);
  }();
  return bodies;
}

BodyMesh make_builtin_body(const MakeHumanFactors& factors, const BodyModel& body) {
  return make_body(builtin_bodies(), factors, body);
}

}  // namespace vesalius::synth
