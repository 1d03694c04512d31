#pragma once

#include <string>
#include <vector>

#include "cluster/engine.h"

namespace vesalius {

/// What engines share whose tasks see one folder: tasks read and write files in the job's folder, by a script.
class FolderEngine : public Engine {
 public:
  FolderEngine(std::unique_ptr<Store> store, EngineOptions options);

  Store& store() override { return *store_; }
  void run(const EngineJob& job) override;
  void end_earlier(const std::string& job) override;

 protected:
  /// Some tasks of a job, by their numbers.
  struct Tasks {
    std::string job;     ///< its name
    std::string folder;  ///< folder of these tasks, a path
    std::string kind;    ///< "map" or "reduce"
    int all = 0;
    std::vector<int> numbers;  ///< numbers of the tasks that are not done
  };

  /// Runs `bash FOLDER/task.sh KIND NUMBER` for each task and returns when all have ended. Whether they succeeded is
  /// seen from their files.
  virtual void run_tasks(const Tasks& tasks) = 0;

  /// Ends the tasks in a folder that a killed driver left behind.
  virtual void end_tasks(const std::string& /*folder*/) {}

  /// Tells how many tasks are done, and what they wait for, if so; throws Interrupted if asked to stop.
  void report(const Tasks& tasks, const std::string& waiting = "") const;
  bool done(const Tasks& tasks, int number) const;
  const EngineOptions& options() const { return options_; }

 private:
  void run_all(const EngineJob& job, const std::string& folder, const std::string& kind, int count);
  std::string script(const EngineJob& job, int maps, const std::string& folder) const;

  std::unique_ptr<Store> store_;
  EngineOptions options_;
};

/// Returns text as one word of a shell.
std::string shell_word(const std::string& text);

/// Returns the line of a task's log that says most: the last one of vesalius, or the last one.
std::string last_words(const std::string& log);

}  // namespace vesalius
