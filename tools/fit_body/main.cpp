// Makes the files of data/bodies that say how bodies are: docs/metrics.md, "Fitting bodies".

#include <CLI/CLI.hpp>
#include <iostream>

#include "../run_tool.h"
#include "fit_body.h"
#include "io/files/atomic_file.h"

namespace vesalius {
namespace {

int run(int argc, char** argv) {
  CLI::App app(
      "Fits how bodies are: the joints of other trackers and how parts lie to each other (for tools/put_fitted.py), "
      "how far joints of fitted bodies can be trusted, stances, and flesh");
  FitTask fit;
  std::string out;
  app.add_option("WHAT", fit.what)->required()->check(CLI::IsMember({"joints", "parts", "trust", "stances", "flesh"}));
  app.add_option("OUT", out, "File to write")->required();
  app.add_option("SOURCE", fit.sources, "Frames with their truth, as `vesalius evaluate` takes them; not for flesh");
  app.add_option(
         "-m,--model", fit.models,
         "Model that finds the people; for joints and parts also several, each of which finds them; not for flesh")
      ->allow_extra_args(false);
  app.add_option("--step", fit.step, "Only the first of every N frames")->check(CLI::PositiveNumber);
  app.add_option("--joint-set", fit.joint_set, "joints: the set to fit, e.g. kinect20; by default the truth's choice");
  app.add_flag("--hidden", fit.hidden, "trust, stances: people who are hidden take part");
  app.add_option("--recipe", fit.recipe, "flesh: recipe of synth whose bodies and poses are taken");
  app.add_option("--assets", fit.assets.folder, "flesh: folder in which `vesalius assets` put its files");
  CLI11_PARSE(app, argc, argv);
  check_writable(out);
  const FittedBodyFile fitted = fit_body(fit);
  write_file_atomically(out, fitted.toml);
  std::cout << fitted.told;
  return 0;
}

}  // namespace
}  // namespace vesalius

int main(int argc, char** argv) {
  return vesalius::run_tool("vesalius_fit_body", [&] { return vesalius::run(argc, argv); });
}
