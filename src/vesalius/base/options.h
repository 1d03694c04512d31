#pragma once

#include <string>

namespace vesalius {

/// What flags, option files and documentation say of one option.
struct OptionInfo {
  const char* unit;  ///< "" for counts and ratios
  double low;        ///< smallest value allowed
  double high;       ///< largest value allowed
  const char* help;  ///< one sentence
};

/// Receives every option of a struct once; the one place from which flags, TOML and documentation are made.
class OptionVisitor {
 public:
  virtual ~OptionVisitor() = default;
  virtual void option(const std::string& name, float& value, const OptionInfo& info) = 0;
  virtual void option(const std::string& name, int& value, const OptionInfo& info) = 0;
  virtual void option(const std::string& name, bool& value, const OptionInfo& info) = 0;
  /// The value is a word, to which the range does not apply; whoever uses it checks it.
  virtual void option(const std::string& name, std::string& value, const OptionInfo& info) = 0;
};

/// Throws UsageError naming the first option outside its range or not finite. Works for every struct that has
/// `void visit_options(const std::string& prefix, Options&, OptionVisitor&)`.
class RangeCheck : public OptionVisitor {
 public:
  void option(const std::string& name, float& value, const OptionInfo& info) override;
  void option(const std::string& name, int& value, const OptionInfo& info) override;
  void option(const std::string& /*name*/, bool& /*value*/, const OptionInfo& /*info*/) override {}
  void option(const std::string& /*name*/, std::string& /*value*/, const OptionInfo& /*info*/) override {}
};

}  // namespace vesalius
