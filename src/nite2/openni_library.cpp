#include "nite2/openni_library.h"

#include <sstream>
#include <string>

#include "standin/program_library.h"
#include "vesalius/error.h"

namespace vesalius::nite2 {

const OpenniLibrary& openni2() {
  static const OpenniLibrary library(standin::find_program_library(
      {"libOpenNI2", "", "VESALIUS_OPENNI2", "oniInitialize", {"libOpenNI2.so.0", "libOpenNI2.so"}}));
  return library;  // tried again where that throws
}

void expect(OniStatus status, const char* what) {
  if (status == ONI_STATUS_OK) return;
  // It comes in lines that begin with tabulators.
  const char* given = openni2().GetExtendedError();
  std::istringstream words(given != nullptr ? given : "");
  std::string reason;
  for (std::string word; words >> word;) reason += (reason.empty() ? "" : " ") + word;
  throw Error(std::string(what) + ": " + (reason.empty() ? "OpenNI says no reason" : reason));
}

}  // namespace vesalius::nite2
