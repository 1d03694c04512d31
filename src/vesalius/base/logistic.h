#pragma once

#include <cmath>

namespace vesalius {

/// Returns the probability of log odds, 0-1.
template <class Number>
Number logistic(Number log_odds) {
  return Number(1) / (Number(1) + std::exp(-log_odds));
}

}  // namespace vesalius
