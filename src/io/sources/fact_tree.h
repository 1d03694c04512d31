#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// Facts as a file has them under whatever names, in objects within objects.
using FactTree = nlohmann::json;

/// Levels of objects and lists that are looked at; calibrations have six.
inline constexpr int kFactLevels = 12;

/// Member of what plain text becomes that has its lines of numbers without a name, each a list.
inline constexpr const char* kNumberRows = "rows of numbers";

/// Reads JSON, YAML and XML (OpenCV's too), TOML, INI or plain text (lines "name: value", "name = value", rows of
/// numbers) as one tree. Marks of byte order are skipped, and UTF-16 is read. Throws Error naming `name`.
FactTree parse_facts(std::string_view text, const std::string& name);

/// Returns the number that a word is as a whole.
std::optional<double> number_of(std::string_view word);
/// Returns a number or a text that is one; nothing for anything else.
std::optional<double> number_of(const FactTree& value);
/// Returns all numbers of a list, of lists in it, of a text of numbers, or of a matrix as OpenCV has it ("data");
/// nothing if anything else is among them.
std::vector<double> numbers_of(const FactTree& value, int levels = kFactLevels);

/// Returns letters and digits of a text in lower case, those after the last dot where it is a name of ORB-SLAM's.
std::string plain_name(std::string_view text);

}  // namespace vesalius
