#include "train/messages/entropy_table.h"

#include <cmath>

#include "train/messages/training_messages.h"

namespace vesalius {

EntropyTable::EntropyTable() : values_(kMostCounted + 1, 0) {
  for (int n = 2; n <= kMostCounted; ++n) {
    values_[n] = static_cast<std::int32_t>(std::lround(kUnitsPerBit * n * std::log2(n)));
  }
}

}  // namespace vesalius
