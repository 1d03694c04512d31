#include "io/sources/source_items.h"

#include <fmt/format.h>

#include <algorithm>

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

std::string with_items(const std::string& message, const std::vector<SourceItem>& items) {
  std::string text = message + "\n" + to_text(items);
  text.pop_back();
  return text;
}

}  // namespace vesalius
