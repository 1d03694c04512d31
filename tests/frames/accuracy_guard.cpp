#include "accuracy_guard.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <memory>

#include "dataset/open_truth.h"
#include "evaluation/evaluation_joints.h"
#include "metrics/score_frame.h"
#include "vesalius/error.h"
#include "vesalius/model.h"
#include "vesalius/model_file.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

[[noreturn]] void fail(const std::string& name, const toml::node& node, const std::string& expected) {
  throw Error(fmt::format("{}:{}: expected {}", name, node.source().begin.line, expected));
}

template <class T>
T value_of(const toml::table& table, const char* key, const std::string& name) {
  const auto value = table[key].value<T>();
  if (!value) fail(name, table, fmt::format("a value for {}", key));
  return *value;
}

std::vector<std::string> words(const toml::table& table, const char* key, const std::string& name) {
  std::vector<std::string> found;
  const toml::array* list = table[key].as_array();
  if (list == nullptr) fail(name, table, fmt::format("a list of frames for {}", key));
  for (const toml::node& item : *list) {
    if (!item.is_string()) fail(name, item, "the name of a frame");
    found.push_back(item.value_or(std::string()));
  }
  return found;
}

void check_keys(const toml::table& table, const std::vector<std::string_view>& known, const std::string& name) {
  for (const auto& [key, node] : table) {
    if (std::ranges::find(known, key.str()) == known.end()) {
      fail(name, node, fmt::format("{}, found {}", fmt::join(known, ", "), key.str()));
    }
  }
}

AcceptedSet parse_set(const toml::table& table, const std::string& name) {
  check_keys(table, {"model", "source", "step", "missed", "false_people", "figure"}, name);
  AcceptedSet set{value_of<std::string>(table, "model", name), value_of<std::string>(table, "source", name),
                  value_of<int>(table, "step", name),          words(table, "missed", name),
                  words(table, "false_people", name),          {}};
  if (set.step < 1) fail(name, table, "a step of at least 1");
  const toml::array* figures = table["figure"].as_array();
  if (figures == nullptr) fail(name, table, "[[set.figure]]");
  for (const toml::node& node : *figures) {
    const toml::table* figure = node.as_table();
    if (figure == nullptr) fail(name, node, "[[set.figure]]");
    check_keys(*figure, {"name", "value", "tolerance"}, name);
    const auto metric = value_of<std::string>(*figure, "name", name);
    if (!parse_metric(metric)) fail(name, *figure, "a metric of docs/metrics.md, found " + metric);
    set.metrics.push_back(
        {metric, value_of<double>(*figure, "value", name), value_of<double>(*figure, "tolerance", name)});
  }
  return set;
}

double term(const FrameScore& score, Metric metric) {
  const auto found = std::ranges::find(score.terms, metric, [](const MetricTerm& term) { return term.id.metric; });
  return found == score.terms.end() ? 0.0 : found->numerator;
}

/// Returns the frames of `now` that are not in `before`.
std::vector<std::string> new_ones(const std::vector<std::string>& now, const std::vector<std::string>& before) {
  std::vector<std::string> found;
  std::ranges::copy_if(now, std::back_inserter(found),
                       [&](const std::string& frame) { return std::ranges::find(before, frame) == before.end(); });
  return found;
}

std::string list_toml(const std::vector<std::string>& frames) {
  return frames.empty() ? "[]" : fmt::format("[\"{}\"]", fmt::join(frames, "\", \""));
}

}  // namespace

std::vector<AcceptedSet> parse_accuracy(std::string_view text, const std::string& name) {
  try {
    const toml::table root = toml::parse(text, name);
    check_keys(root, {"set"}, name);
    std::vector<AcceptedSet> sets;
    const toml::array* list = root["set"].as_array();
    if (list == nullptr) throw Error(name + ": expected [[set]]");
    for (const toml::node& node : *list) {
      if (!node.is_table()) fail(name, node, "[[set]]");
      sets.push_back(parse_set(*node.as_table(), name));
    }
    return sets;
  } catch (const toml::parse_error& e) {
    throw Error(fmt::format("{}:{}: {}", name, e.source().begin.line, e.description()));
  }
}

MeasuredSet measure(const AcceptedSet& set, const std::string& project, const std::string& source) {
  Model model = load_model(project + "/" + set.model);
  model.body = with_evaluation_joints(model.body);
  const FrameScorer scorer(std::move(model), {});
  const auto truth = open_truth(source, set.step);
  std::vector<TrueFrame> frames;
  while (auto frame = truth->next()) frames.push_back(std::move(*frame));
  std::vector<FrameScore> scores(frames.size());
  parallel_for(static_cast<int>(frames.size()), [&](int i) { scores[i] = scorer.score(frames[i], false); });
  MeasuredSet now;
  MetricTable table;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::string& name = frames[i].frame.name;
    ++now.frames;
    table.add(frame_key("", name.c_str()), scores[i].terms);
    if (term(scores[i], Metric::people_found) < scores[i].expected) now.missed.push_back(name);
    if (term(scores[i], Metric::people_false) > 0.0) now.false_people.push_back(name);
  }
  for (const Estimate& estimate : table.estimates()) now.metrics[estimate.id.name()] = estimate.value;
  return now;
}

std::vector<std::string> what_got_worse(const AcceptedSet& accepted, const MeasuredSet& now) {
  std::vector<std::string> lines;
  for (const AcceptedMetric& metric : accepted.metrics) {
    const auto found = now.metrics.find(metric.name);
    if (found == now.metrics.end()) {
      lines.push_back(fmt::format("{}: no {} any more", accepted.source, metric.name));
      continue;
    }
    const bool higher = info(parse_metric(metric.name).value().metric).direction == MetricDirection::higher_is_better;
    const double gain = higher ? found->second - metric.value : metric.value - found->second;
    if (gain >= -metric.tolerance - 1e-9) continue;
    lines.push_back(fmt::format("{}: {} is {:.4f}, accepted were {:.4f} with a tolerance of {}", accepted.source,
                                metric.name, found->second, metric.value, metric.tolerance));
  }
  if (lines.empty()) return lines;
  const auto add_frames = [&](const char* what, const std::vector<std::string>& frames) {
    if (!frames.empty()) lines.push_back(fmt::format("{}: {}: {}", accepted.source, what, fmt::join(frames, " ")));
  };
  add_frames("somebody is missed who was found", new_ones(now.missed, accepted.missed));
  add_frames("somebody is found who was missed", new_ones(accepted.missed, now.missed));
  add_frames("nobody is taken for somebody, and was not", new_ones(now.false_people, accepted.false_people));
  add_frames("nobody was taken for somebody, and is no more", new_ones(accepted.false_people, now.false_people));
  return lines;
}

std::string accuracy_toml(const AcceptedSet& accepted, const MeasuredSet& now) {
  std::string toml = fmt::format("[[set]]  # {} frames\nmodel = \"{}\"\nsource = \"{}\"\nstep = {}\n", now.frames,
                                 accepted.model, accepted.source, accepted.step);
  toml += fmt::format("missed = {}\nfalse_people = {}\n", list_toml(now.missed), list_toml(now.false_people));
  for (const AcceptedMetric& metric : accepted.metrics) {
    const auto found = now.metrics.find(metric.name);
    if (found == now.metrics.end()) continue;
    toml += fmt::format("\n[[set.figure]]\nname = \"{}\"\nvalue = {:.4f}\ntolerance = {}\n", metric.name, found->second,
                        metric.tolerance);
  }
  return toml;
}

}  // namespace vesalius
