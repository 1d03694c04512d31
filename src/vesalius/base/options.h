#pragma once

#include <string>

namespace vesalius {

/// The description of an option for flags, option files and documentation.
struct OptionInfo {
  const char* unit;  ///< "" for counts and ratios
  double low;        ///< smallest value allowed
  double high;       ///< largest value allowed
  const char* help;  ///< one sentence
};

/// Receives every option of a struct once. Flags, TOML and documentation are all made from this.
class OptionVisitor {
 public:
  virtual ~OptionVisitor() = default;
  virtual void option(const std::string& name, float& value, const OptionInfo& info) = 0;
  virtual void option(const std::string& name, int& value, const OptionInfo& info) = 0;
  virtual void option(const std::string& name, bool& value, const OptionInfo& info) = 0;
  /// Receives an option whose value is a word. The range does not apply to it; its user checks it.
  virtual void option(const std::string& name, std::string& value, const OptionInfo& info) = 0;
};

/// Throws UsageError naming the first option that is not finite or outside its range. It works for every struct that
/// has `void visit_options(const std::string& prefix, Options&, OptionVisitor&)`.
class RangeCheck : public OptionVisitor {
 public:
  void option(const std::string& name, float& value, const OptionInfo& info) override;
  void option(const std::string& name, int& value, const OptionInfo& info) override;
  void option(const std::string& /*name*/, bool& /*value*/, const OptionInfo& /*info*/) override {}
  void option(const std::string& /*name*/, std::string& /*value*/, const OptionInfo& /*info*/) override {}
};

}  // namespace vesalius
