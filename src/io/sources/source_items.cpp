#include <fmt/format.h>

#include <algorithm>

#include "vesalius/frame_source.h"

namespace vesalius {

std::string to_text(const std::vector<SourceItem>& items) {
  std::size_t name = 0, holds = 0;
  for (const SourceItem& item : items) {
    name = std::max(name, item.name.size());
    holds = std::max(holds, item.holds.size());
  }
  std::string text;
  for (const SourceItem& item : items) {
    const std::string use = item.use.empty() ? "not taken" : item.use;
    const std::string count = item.count < 0 ? "" : std::to_string(item.count);
    text += fmt::format("  {:<{}}  {:<{}}  {:>6}  {}{}{}\n", item.name, name, item.holds, holds, count, use,
                        item.why.empty() ? "" : ": ", item.why);
  }
  return text;
}

}  // namespace vesalius
