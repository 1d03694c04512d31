#pragma once

#include <string>
#include <string_view>

namespace vesalius {

/// Returns whether a file of this name is still being written, or was when its writer was killed.
bool is_temporary_name(const std::string& name);

/// Returns whether `name` is relative, of letters, digits, '.', '_' and '-', with single '/' between folders, none of
/// them "." or "..".
bool is_store_name(std::string_view name);

/// Throws UsageError unless `name` is such a name, and not a temporary one.
void check_store_name(const std::string& name);

/// The same for folders that are listed: the empty name is the store itself.
void check_store_folder(const std::string& name);

}  // namespace vesalius
