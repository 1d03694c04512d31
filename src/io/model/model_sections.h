#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// A model file is a table of named sections and then these (docs/formats.md). What they hold is model_contents.h.
namespace vesalius {

/// Version of the model files that this program writes and reads.
inline constexpr int kModelVersion = 3;

/// A section of a model file as its table names it.
struct ModelSection {
  std::string name;
  int version = 1;         ///< version of the section's content
  bool skippable = false;  ///< whether a reader that does not know it goes on without it
  std::string made_from;   ///< free text
  std::string_view bytes = {};
  std::uint64_t checksum = 0;  ///< XXH64 of the bytes
};

/// Returns the bytes of a model file with these sections; their checksums are worked out.
std::string join_sections(const std::vector<ModelSection>& sections);

/// Returns the sections of a model file, whose bytes they refer to; `name` is used as the path in errors. Throws Error
/// for what is no model or has another version, and names the section that is damaged, cut off or there twice. Without
/// `checked` checksums are not compared.
std::vector<ModelSection> split_sections(std::string_view bytes, const std::string& name, bool checked = true);

/// Returns the version that a model file states; 0 for what is no model.
int model_version(std::string_view bytes);

/// Returns XXH64, seed 0, of bytes and those that follow them.
std::uint64_t xxh64(std::string_view bytes, std::string_view rest = {});

}  // namespace vesalius
