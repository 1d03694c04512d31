#include <string>
#include <utility>

#include "c/guard.h"
#include "c/handles.h"
#include "vesalius/vesalius.h"

namespace vesalius::c {
namespace {

static_assert(int(OptionKind::number) == VESALIUS_OPTION_NUMBER &&
              int(OptionKind::whole_number) == VESALIUS_OPTION_WHOLE_NUMBER &&
              int(OptionKind::truth) == VESALIUS_OPTION_TRUTH && int(OptionKind::word) == VESALIUS_OPTION_WORD);

VisitAll visit(PeopleOptions& options) {
  return [&options](OptionVisitor& visitor) { visit_options("", options, visitor); };
}

/// Changes the options, or, if that throws, nothing.
template <class Change>
void change(vesalius_options& options, const Change& change_all) {
  PeopleOptions values = options.values;
  change_all(visit(values));
  std::vector<OptionText> texts = list_options(visit(values));
  options.values = std::move(values);
  options.texts = std::move(texts);
}

}  // namespace
}  // namespace vesalius::c

using namespace vesalius;
using namespace vesalius::c;

vesalius_status vesalius_options_create(vesalius_options** options) {
  return guarded([&] {
    need(options, "options") = nullptr;
    auto made = std::make_unique<vesalius_options>();
    change(*made, [](const VisitAll&) {});
    *options = made.release();
  });
}

vesalius_status vesalius_options_set(vesalius_options* options, const char* name, const char* value) {
  return guarded([&] {
    need(name, "name");
    need(value, "value");
    change(need(options, "options"), [&](const VisitAll& all) { set_option(name, value, all); });
  });
}

vesalius_status vesalius_options_load(vesalius_options* options, const char* path) {
  return guarded([&] {
    need(path, "path");
    change(need(options, "options"), [&](const VisitAll& all) { read_options(path, all); });
  });
}

int32_t vesalius_options_count(const vesalius_options* options) {
  return guarded_value(-1, [&] { return static_cast<int32_t>(need(options, "options").texts.size()); });
}

vesalius_status vesalius_options_get(const vesalius_options* options, int32_t index, vesalius_option* option) {
  return guarded([&] {
    const OptionText& text = at(need(options, "options").texts, index, "option");
    vesalius_option described{};
    described.kind = static_cast<int32_t>(text.kind);
    described.name = text.name.c_str();
    described.value = text.value.c_str();
    described.unit = text.info.unit;
    described.help = text.info.help;
    described.low = text.info.low;
    described.high = text.info.high;
    write_struct(described, option, "option");
  });
}

void vesalius_options_destroy(vesalius_options* options) { delete options; }
