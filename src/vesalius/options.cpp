#include "vesalius/options.h"

#include <cmath>
#include <sstream>

#include "vesalius/error.h"

namespace vesalius {
namespace {

void check_range(const std::string& name, double value, const OptionInfo& info) {
  if (std::isfinite(value) && value >= info.low && value <= info.high) return;
  std::ostringstream message;
  message << "option " << name << " is " << value << ", expected " << info.low << " to " << info.high;
  if (*info.unit != '\0') message << ' ' << info.unit;
  throw UsageError(message.str());
}

}  // namespace

void RangeCheck::option(const std::string& name, float& value, const OptionInfo& info) {
  check_range(name, static_cast<double>(value), info);
}

void RangeCheck::option(const std::string& name, int& value, const OptionInfo& info) { check_range(name, value, info); }

}  // namespace vesalius
