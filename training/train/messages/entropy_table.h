#pragma once

#include <cstdint>
#include <vector>

namespace vesalius {

/// Entropies as integers, so that splits do not depend on the order of additions. The table gives 1024 n log2 n,
/// rounded, for n up to kMostCounted. Sums over the classes of a node stay below 2^31.
class EntropyTable {
 public:
  static constexpr double kUnitsPerBit = 1024.0;

  EntropyTable();
  std::int32_t operator()(std::int64_t n) const { return values_[n]; }
  const std::int32_t* data() const { return values_.data(); }

 private:
  std::vector<std::int32_t> values_;
};

}  // namespace vesalius
