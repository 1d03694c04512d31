#include "vesalius/base/find_joint_set.h"

#include <algorithm>
#include <string>

#include "vesalius/base/error.h"
#include "vesalius/base/toml_reader.h"

namespace vesalius {

std::size_t find_joint_set(const BodyModel& body, std::string_view name) {
  const auto found = std::ranges::find(body.joint_sets, name, &JointSet::name);
  if (found != body.joint_sets.end()) return static_cast<std::size_t>(found - body.joint_sets.begin());
  std::string known;
  for (const JointSet& set : body.joint_sets) known += (known.empty() ? "" : ", ") + set.name;
  throw UsageError("joint set " + in_quotes(name) + " is not of this body, expected one of: " + known);
}

}  // namespace vesalius
