#pragma once

#include "standin/guard.h"

namespace vesalius::nite2 {

inline constexpr standin::Guard kGuard("libNiTE2");

}  // namespace vesalius::nite2
