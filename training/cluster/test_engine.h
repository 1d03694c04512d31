#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "cluster/engine.h"
#include "cluster/map_task.h"
#include "cluster/reduce_task.h"
#include "vesalius/error.h"

namespace vesalius::test {

/// A store in memory.
class MemoryStore : public Store {
 public:
  std::string place() const override { return "memory"; }
  std::string read(const std::string& name) const override {
    const auto found = files.find(name);
    if (found == files.end()) throw Error("memory/" + name + ": no such file");
    return found->second;
  }
  bool exists(const std::string& name) const override { return files.contains(name); }
  void write(const std::string& name, const std::string& bytes) override { files[name] = bytes; }
  std::vector<std::string> list(const std::string& folder) const override {
    std::set<std::string> names;
    for (const auto& [name, bytes] : files) {
      if (!name.starts_with(folder + "/")) continue;
      const std::string rest = name.substr(folder.size() + 1);
      names.insert(rest.substr(0, rest.find('/')));
    }
    return {names.begin(), names.end()};
  }
  void remove(const std::string& name) override {
    std::erase_if(files, [&](const auto& file) { return file.first == name || file.first.starts_with(name + "/"); });
  }

  std::map<std::string, std::string> files;
};

/// What an engine may do.
struct TestEngineOptions {
  int map_tasks = 1, reduce_tasks = 1;
  bool combine = false;
  bool twice = false;          ///< every output of a map task comes twice
  int jobs_before_end = 1000;  ///< after so many jobs the driver is stopped
};

/// Runs jobs within this process, one task after the other, as the contract says.
class TestEngine : public Engine {
 public:
  TestEngine(Store& store, TaskContext::ReadFrame read, TestEngineOptions options)
      : store_(store), read_(std::move(read)), options_(options) {}

  Store& store() override { return store_; }

  void run(const EngineJob& job) override {
    if (jobs++ >= options_.jobs_before_end) throw Error("killed");
    const TaskContext context{
        .store = store_, .job = job.name, .open_source = [&](const std::string& /*source*/) { return read_; }};
    std::vector<std::string> inputs(options_.map_tasks);
    for (std::size_t i = 0; i < job.lines.size(); ++i) inputs[i % inputs.size()] += job.lines[i] + "\n";
    std::vector<std::vector<std::string>> parts(options_.reduce_tasks);
    for (std::size_t m = 0; m < inputs.size(); ++m) {
      std::istringstream in(inputs[m]);
      std::ostringstream out;
      run_map_task(context, in, out);
      std::string text = out.str();
      if (!job.reduced) {
        store_.write(result_folder(job.name) + "/part-" + std::to_string(m), text);
        continue;
      }
      if (options_.combine && job.summed) text = combined(text);
      for (int copy = options_.twice ? 2 : 1; copy > 0; --copy) {
        for (const std::string& line : lines_of(text)) {
          parts[part_of(line.substr(0, line.find('\t')), options_.reduce_tasks)].push_back(line);
          bytes += line.size();
        }
      }
    }
    for (std::size_t r = 0; job.reduced && r < parts.size(); ++r) {
      std::istringstream in(joined(parts[r]));
      std::ostringstream out;
      run_reduce_task(context, in, out);
      store_.write(result_folder(job.name) + "/part-" + std::to_string(r), out.str());
    }
    store_.write(result_folder(job.name) + "/_SUCCESS", "");
  }

  int jobs = 0;
  std::size_t bytes = 0;  ///< between map and reduce tasks

 private:
  static std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }
  static std::string joined(std::vector<std::string> lines) {
    std::ranges::stable_sort(lines, {}, [](const std::string& line) { return line.substr(0, line.find('\t')); });
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
  }
  static std::string combined(const std::string& text) {
    std::istringstream in(joined(lines_of(text)));
    std::ostringstream out;
    run_combine_task(in, out);
    return out.str();
  }

  Store& store_;
  TaskContext::ReadFrame read_;
  TestEngineOptions options_;
};

}  // namespace vesalius::test
