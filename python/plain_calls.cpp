#include "plain_calls.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace vesalius {
namespace {

/// Lets a function answer what no constructor of a class takes. It is one more constructor, which nanobind comes to
/// when no other fits: first it tries all without converting anything, where a float that is given as a whole number
/// does not fit.
void answer_wrong_construction(nb::handle type, nb::object answer) {
  nb::cpp_function_def([answer = std::move(answer)](nb::handle /*self*/, const nb::args& args, float /*last*/,
                                                    const nb::kwargs& keywords) { answer(*args, **keywords); },
                       nb::scope(type), nb::name("__init__"), nb::is_method(), "args"_a, "_"_a = nb::int_(0),
                       "keywords"_a, nb::sig("def __init__(...)"));
}

}  // namespace

void bind_plain_calls(nb::module_& m) {
  m.def("_answer_wrong_construction", &answer_wrong_construction, "type"_a, "answer"_a);
}

}  // namespace vesalius
