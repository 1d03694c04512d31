#include "options_from_keywords.h"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/files/options_file.h"
#include "vesalius/error.h"

namespace nb = nanobind;

namespace vesalius {
namespace {

std::string keyword_of(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return c == '.' || c == '-'; }, '_');
  return name;
}

/// Sets those options that have a keyword.
class Setter : public OptionVisitor {
 public:
  explicit Setter(const nb::dict& keywords) {
    for (const auto& [key, value] : keywords) values_.emplace(nb::cast<std::string>(key), value);
  }
  void option(const std::string& name, float& value, const OptionInfo& /*info*/) override {
    take(name, "a number", [&](nb::handle given) {
      const auto number = nb::cast<double>(given);
      value = static_cast<float>(number);
    });
  }
  void option(const std::string& name, int& value, const OptionInfo& /*info*/) override {
    take(name, "a whole number", [&](nb::handle given) {
      if (nb::isinstance<nb::bool_>(given)) throw nb::cast_error();
      value = nb::cast<int>(given);
    });
  }
  void option(const std::string& name, bool& value, const OptionInfo& /*info*/) override {
    take(name, "True or False", [&](nb::handle given) {
      if (!nb::isinstance<nb::bool_>(given)) throw nb::cast_error();
      value = nb::cast<bool>(given);
    });
  }
  void option(const std::string& name, std::string& value, const OptionInfo& /*info*/) override {
    take(name, "a word", [&](nb::handle given) { value = nb::cast<std::string>(given); });
  }

  void expect_all_taken() const {
    for (const auto& [name, unused] : values_) {
      if (taken_.contains(name)) continue;
      const std::string nearest = keyword_of(nearest_name(name, known_));
      throw UsageError(name + " is no option" +
                       (nearest.empty() ? "; vesalius.options() lists them" : "; did you mean " + nearest + "?"));
    }
  }

 private:
  template <class Set>
  void take(const std::string& name, const char* expected, const Set& set) {
    known_.push_back(name);
    std::ranges::replace(known_.back(), '-', '_');
    const auto found = values_.find(keyword_of(name));
    if (found == values_.end()) return;
    taken_.insert(found->first);
    try {
      set(found->second);
    } catch (const std::exception&) {
      throw UsageError(found->first + ": expected " + expected);
    }
  }

  std::map<std::string, nb::handle> values_;
  std::vector<std::string> known_;  ///< keywords, a dot behind the stage, which may be left out by mistake
  std::set<std::string> taken_;
};

nb::object value_of(const OptionText& option) {
  switch (option.kind) {
    case OptionKind::number:
      return nb::float_(std::stod(option.value));
    case OptionKind::whole_number:
      return nb::int_(std::stoi(option.value));
    case OptionKind::truth:
      return nb::bool_(option.value == "true");
    default:
      return nb::str(option.value.c_str());
  }
}

/// Returns a value as Python writes it.
std::string as_python(const OptionText& option) {
  switch (option.kind) {
    case OptionKind::truth:
      return option.value == "true" ? "True" : "False";
    case OptionKind::word:
      return "\"" + option.value + "\"";
    default:
      return option.value;
  }
}

}  // namespace

void set_options(PeopleOptions& options, const nb::dict& keywords) {
  Setter setter(keywords);
  visit_options("", options, setter);
  setter.expect_all_taken();
  RangeCheck check;
  visit_options("", options, check);
}

nb::dict options_as_dict(PeopleOptions options) {
  nb::dict values;
  for (const OptionText& option : list_options([&](OptionVisitor& visitor) { visit_options("", options, visitor); })) {
    values[keyword_of(option.name).c_str()] = value_of(option);
  }
  return values;
}

std::string describe_options() {
  PeopleOptions options;
  std::string text;
  for (const OptionText& option : list_options([&](OptionVisitor& visitor) { visit_options("", options, visitor); })) {
    const std::string unit = *option.info.unit != '\0' ? std::string(" ") + option.info.unit : "";
    text += keyword_of(option.name) + " = " + as_python(option) + unit + ": " + option.info.help + "\n";
  }
  return text;
}

}  // namespace vesalius
