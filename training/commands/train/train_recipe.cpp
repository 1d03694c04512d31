#include "commands/train/train_recipe.h"

#include <fmt/format.h>

#include <string_view>

#include "downloads/sha256.h"
#include "io/files/data_file.h"
#include "io/files/options_file.h"

namespace vesalius::cli {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

bool is_comment(const std::string& line) { return line.starts_with('#'); }

/// Returns options without their explanations, since this text is for programs to read.
std::string without_help(const std::string& toml, std::string_view indent) {
  const std::vector<std::string> lines = lines_of(toml);
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const bool help =
        is_comment(lines[i]) && i + 1 < lines.size() && !lines[i + 1].empty() && !is_comment(lines[i + 1]);
    if (!lines[i].empty() && !help) text.append(indent).append(lines[i]).append("\n");
  }
  return text;
}

/// Returns the text under two lines that name the program and a sum of the text.
std::string with_key(const std::string& text) {
  return fmt::format("# vesalius train {}\n# key {}\n{}", VESALIUS_VERSION, sha256_of(text), text);
}

std::string source_text(const std::string& what, const TrainInput& input) {
  return fmt::format("# {}: {} frames, seed {}, hash {:016x}, made by\n", what, input.frames, input.seed, input.hash) +
         without_help(input.made_by, "#   ");
}

}  // namespace

std::string train_recipe(TrainOptions options, const TrainInputs& inputs,
                         const std::vector<BackgroundFacts>& backgrounds) {
  const auto all = [&](OptionVisitor& visitor) { visit_options("", options, visitor); };
  std::string text = without_help(options_toml(all), "");
  text += fmt::format("# body {}: sha256 {}\n", inputs.body().name, sha256_of(inputs.body().toml));
  for (std::size_t i = 0; i < backgrounds.size(); ++i) {
    text += fmt::format("# background {}: {} frames, sha256 {}\n", i + 1, backgrounds[i].frames, backgrounds[i].sha256);
  }
  for (std::size_t i = 0; i < inputs.inputs().size(); ++i) {
    text += source_text(fmt::format("data {}", i + 1), inputs.inputs()[i]);
  }
  return with_key(text);
}

std::string network_recipe(const NetworkOptions& options, const BodyModel& body,
                           const std::vector<TrainInput>& inputs) {
  std::string text = fmt::format("# network\nconfig = \"{}\"\nviews = {}\nbatch = {}\nrate = {}\nseed = {}\n",
                                 options.config, options.views, options.batch, options.rate, options.seed);
  if (!options.init.empty())
    text += fmt::format("# begun with weights: sha256 {}\n", sha256_of(read_file(options.init)));
  text += fmt::format("# body {}: sha256 {}\n", body.name, sha256_of(body.toml));
  for (std::size_t i = 0; i < inputs.size(); ++i) text += source_text(fmt::format("data {}", i + 1), inputs[i]);
  return with_key(text);
}

std::string fitted_recipe(const std::string& what, int step, const std::vector<TrainInput>& inputs,
                          const std::string& before) {
  std::string text = fmt::format("# {}, fitted to the first of every {} frames, with a model made by {}\n", what, step,
                                 sha256_of(before));
  for (std::size_t i = 0; i < inputs.size(); ++i) text += source_text(fmt::format("data {}", i + 1), inputs[i]);
  return with_key(text);
}

std::string first_difference(const std::string& before, const std::string& now) {
  const std::vector<std::string> old_lines = lines_of(before);
  const std::vector<std::string> new_lines = lines_of(now);
  std::string difference;
  for (std::size_t i = 0; i < std::max(old_lines.size(), new_lines.size()); ++i) {
    const std::string then = i < old_lines.size() ? old_lines[i] : "nothing";
    const std::string here = i < new_lines.size() ? new_lines[i] : "nothing";
    if (then == here) continue;
    difference = fmt::format("`{}` before, now `{}`", then, here);
    if (!here.starts_with("# key ")) break;  // the key is skipped, since it differs whenever anything does
  }
  return difference;
}

}  // namespace vesalius::cli
