#pragma once

#include "standin/guard.h"

namespace vesalius::k4abt {

inline constexpr standin::Guard kGuard("libk4abt");

}  // namespace vesalius::k4abt
