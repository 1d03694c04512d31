// Measures the lengths of a body's links on labelled frames: a Markdown table with a row for each link.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <optional>

#include "../run_tool.h"
#include "dataset/labelled_truth.h"
#include "dataset/open_truth.h"
#include "link_lengths.h"
#include "vesalius/detect.h"
#include "vesalius/error.h"
#include "vesalius/model_file.h"

namespace vesalius {
namespace {

void print(const BodyModel& body, const std::vector<LinkFigures>& figures) {
  std::cout << "| link | pairs | length, mm | 90 % within | the same, scaled";
  for (std::size_t i = 0; i < kStatureBands_m.size(); ++i) std::cout << fmt::format(" | to {} m", kStatureBands_m[i]);
  std::cout << " | above |\n|---|---|---|---|---";
  for (std::size_t i = 0; i <= kStatureBands_m.size(); ++i) std::cout << "|---";
  std::cout << "|\n";
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const BodyLink& link = body.links[i];
    const LinkFigures& f = figures[i];
    std::cout << fmt::format("| {} - {} | {} | {:.0f} | {:.0f} | {:.0f}", body.parts[link.parent].name,
                             body.parts[link.child].name, f.pairs, 1e3F * f.length_m, 1e3F * f.spread_m,
                             1e3F * f.scaled_spread_m);
    for (const float median : f.band_m) std::cout << fmt::format(" | {:.0f}", 1e3F * median);
    std::cout << " |\n";
  }
}

int run(int argc, char** argv) {
  CLI::App app(
      "Distances between the visible centres of linked parts: their median for a stature of 1.7 m, what 90 % are "
      "within "
      "of it, with and without scaling by stature, and the median by stature");
  std::vector<std::string> sources;
  std::string model;
  app.add_option("DATASET", sources, "Labelled datasets of `vesalius synth`")->required();
  app.add_option("-m,--model", model, "Forest that labels the people; without it their true labels are taken")
      ->type_name("FILE");
  CLI11_PARSE(app, argc, argv);
  std::optional<Detector> detector;
  if (!model.empty()) detector.emplace(load_model(model));
  const BodyModel body = detector ? detector->body() : paper_body();
  LinkLengths lengths(body);
  for (const std::string& uri : sources) {
    const auto source = open_truth(uri);
    if (source->part_names() != part_names_of(body)) {
      throw Error(fmt::format("{}: expected frames labelled with the parts of the body {}", uri, body.name));
    }
    while (const auto frame = source->next()) {
      const Mask people = labelled_people(frame->truth);
      lengths.add(*frame, detector ? detector->label(frame->frame, &people).inside : frame->truth.labels);
    }
  }
  print(body, lengths.figures());
  return 0;
}

}  // namespace
}  // namespace vesalius

int main(int argc, char** argv) {
  return vesalius::run_tool("vesalius_link_lengths", [&] { return vesalius::run(argc, argv); });
}
