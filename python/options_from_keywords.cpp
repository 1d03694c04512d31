#include "options_from_keywords.h"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "vesalius/base/error.h"

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
      if (!taken_.contains(name)) throw UsageError(name + " is no option; vesalius.options() lists them");
    }
  }

 private:
  template <class Set>
  void take(const std::string& name, const char* expected, const Set& set) {
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
  std::set<std::string> taken_;
};

class Describer : public OptionVisitor {
 public:
  void option(const std::string& name, float& value, const OptionInfo& info) override {
    add(name, std::to_string(value), info);
  }
  void option(const std::string& name, int& value, const OptionInfo& info) override {
    add(name, std::to_string(value), info);
  }
  void option(const std::string& name, bool& value, const OptionInfo& info) override {
    add(name, value ? "True" : "False", info);
  }
  void option(const std::string& name, std::string& value, const OptionInfo& info) override {
    add(name, "\"" + value + "\"", info);
  }

  std::string text;

 private:
  void add(const std::string& name, std::string value, const OptionInfo& info) {
    if (value.find('.') != std::string::npos && value.front() != '"') {
      value.erase(value.find_last_not_of('0') + 1);
      if (value.back() == '.') value += '0';
    }
    const std::string unit = *info.unit != '\0' ? std::string(" ") + info.unit : "";
    text += keyword_of(name) + " = " + value + unit + ": " + info.help + "\n";
  }
};

}  // namespace

void set_options(PeopleOptions& options, const nb::dict& keywords) {
  Setter setter(keywords);
  visit_options("", options, setter);
  setter.expect_all_taken();
  RangeCheck check;
  visit_options("", options, check);
}

std::string describe_options() {
  PeopleOptions options;
  Describer describer;
  visit_options("", options, describer);
  return describer.text;
}

}  // namespace vesalius
