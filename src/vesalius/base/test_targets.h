#pragma once

#include <hwy/targets.h>

#include <cstdint>

namespace vesalius {

/// Calls `work(name)` once for each instruction set, e.g. "AVX3", that this machine has and the build supports; kernels
/// run on it meanwhile. It is for tests and measurements, and no other thread may run kernels at the same time.
template <class Work>
void for_each_target(const Work& work) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    work(hwy::TargetName(target));
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace vesalius
