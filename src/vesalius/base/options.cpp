#include "vesalius/base/options.h"

#include <cmath>
#include <sstream>

#include "vesalius/error.h"

namespace vesalius {
namespace {

/// Converts `low` and `high` to the value's own precision, so that the ends of the range are included.
template <class T>
void check_range(const std::string& name, T value, const OptionInfo& info) {
  if (std::isfinite(double(value)) && value >= static_cast<T>(info.low) && value <= static_cast<T>(info.high)) {
    return;
  }
  std::ostringstream message;
  message << "option " << name << " is " << value << ", expected " << info.low << " to " << info.high;
  if (*info.unit != '\0') message << ' ' << info.unit;
  throw UsageError(message.str());
}

}  // namespace

void RangeCheck::option(const std::string& name, float& value, const OptionInfo& info) {
  check_range(name, value, info);
}

void RangeCheck::option(const std::string& name, int& value, const OptionInfo& info) { check_range(name, value, info); }

}  // namespace vesalius
