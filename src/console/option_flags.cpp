#include "console/option_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <variant>

namespace vesalius::cli {

struct FlagSet::Flag {
  const CLI::Option* option;
  std::variant<const float*, const int*, const bool*, const std::string*> value;
};

namespace {

constexpr const char* kHidden = "";

std::string described(const OptionInfo& info) {
  const std::string unit = *info.unit == '\0' ? "" : fmt::format(" {}", info.unit);
  return fmt::format("{} ({} to {}{})", info.help, info.low, info.high, unit);
}

template <class Flag>
class Adder : public OptionVisitor {
 public:
  Adder(CLI::App& command, std::vector<Flag>& flags) : command_(command), flags_(flags) {}

  void option(const std::string& name, float& value, const OptionInfo& info) override {
    keep(command_.add_option("--" + name, value, described(info)), &value);
  }
  void option(const std::string& name, int& value, const OptionInfo& info) override {
    keep(command_.add_option("--" + name, value, described(info)), &value);
  }
  void option(const std::string& name, bool& value, const OptionInfo& info) override {
    keep(command_.add_flag(fmt::format("--{0},!--no-{0}", name), value, info.help), &value);
  }
  void option(const std::string& name, std::string& value, const OptionInfo& info) override {
    keep(command_.add_option("--" + name, value, info.help), &value);
  }

 private:
  template <class T>
  void keep(CLI::Option* option, const T* value) {
    option->group(kHidden)->default_str(fmt::format("{}", *value));
    flags_.push_back({option, value});
  }

  CLI::App& command_;
  std::vector<Flag>& flags_;
};

/// Visits the options in the order in which their flags were added.
template <class Flag>
class Copier : public OptionVisitor {
 public:
  explicit Copier(const std::vector<Flag>& flags) : next_(flags.begin()) {}
  void option(const std::string& /*name*/, float& value, const OptionInfo& /*info*/) override { copy(value); }
  void option(const std::string& /*name*/, int& value, const OptionInfo& /*info*/) override { copy(value); }
  void option(const std::string& /*name*/, bool& value, const OptionInfo& /*info*/) override { copy(value); }
  void option(const std::string& /*name*/, std::string& value, const OptionInfo& /*info*/) override { copy(value); }

 private:
  template <class T>
  void copy(T& value) {
    if (next_->option->count() > 0) value = *std::get<const T*>(next_->value);
    ++next_;
  }

  typename std::vector<Flag>::const_iterator next_;
};

}  // namespace

FlagSet::FlagSet(CLI::App& command, const VisitAll& visit) {
  Adder<Flag> adder(command, flags_);
  visit(adder);
}

FlagSet::~FlagSet() = default;

void FlagSet::apply(const VisitAll& visit) const {
  Copier<Flag> copier(flags_);
  visit(copier);
}

}  // namespace vesalius::cli
