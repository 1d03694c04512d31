#pragma once

#include <string>

namespace vesalius::cli {

/// Opens the address in the user's browser if this is a desktop with one, and does not wait for it.
void open_browser(const std::string& address);

}  // namespace vesalius::cli
