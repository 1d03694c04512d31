#pragma once

#include <hwy/targets.h>

#include <cstdint>

namespace vesalius {

/// Calls `work(name)` with kernels running on each instruction set that this machine has and the build made code for,
/// e.g. "AVX3": for tests and measurements. Not while other threads run kernels.
template <class Work>
void for_each_target(const Work& work) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    work(hwy::TargetName(target));
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace vesalius
