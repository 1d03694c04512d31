#include "c/guard.h"
#include "vesalius/vesalius.h"

static_assert(VESALIUS_VERSION_MAJOR == VESALIUS_PROJECT_MAJOR && VESALIUS_VERSION_MINOR == VESALIUS_PROJECT_MINOR &&
                  VESALIUS_VERSION_PATCH == VESALIUS_PROJECT_PATCH,
              "the version of the header is that of the project");

const char* vesalius_version() { return VESALIUS_PROJECT_VERSION; }

int32_t vesalius_abi_version() { return VESALIUS_ABI_VERSION; }

const char* vesalius_last_error() { return vesalius::c::last_error(); }
