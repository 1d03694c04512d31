#pragma once

#include <functional>
#include <memory>

#include "dataset/truth_source.h"

namespace vesalius {

/// Returns the frames of a source as `change` makes them; all else is the source's.
std::unique_ptr<TruthSource> mapped(std::unique_ptr<TruthSource> frames, std::function<TrueFrame(TrueFrame)> change);

}  // namespace vesalius
