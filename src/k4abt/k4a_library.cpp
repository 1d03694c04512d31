#include "k4abt/k4a_library.h"

#include "standin/program_library.h"

namespace vesalius::k4abt {

const K4aLibrary& k4a() {
  static const K4aLibrary library(standin::find_program_library(
      {"libk4a", "libk4abt", "VESALIUS_K4A", "k4a_image_create", {"libk4a.so.1.4", "libk4a.so"}}));
  return library;  // tried again where that throws
}

}  // namespace vesalius::k4abt
