#pragma once

namespace CLI {
class App;
}

namespace vesalius::cli {

/// Makes `program` the program vesalius with the commands of this build. It must live as long as these.
void describe_program(CLI::App& program);

}  // namespace vesalius::cli
