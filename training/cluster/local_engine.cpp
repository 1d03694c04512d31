#include <chrono>
#include <thread>
#include <utility>

#include "cluster/folder_engine.h"
#include "cluster/process.h"

namespace vesalius {
namespace {

constexpr std::chrono::milliseconds kPause{20};
constexpr int kReportEvery = 10;  ///< pauses

class LocalEngine : public FolderEngine {
 public:
  LocalEngine(std::unique_ptr<Store> store, const EngineOptions& options, int processes)
      : FolderEngine(std::move(store), options), processes_(processes) {}

 protected:
  void run_tasks(const Tasks& tasks) override {
    std::vector<ChildProcess> running;
    auto next = tasks.numbers.begin();
    for (int pause = 0; next != tasks.numbers.end() || !running.empty(); ++pause) {
      std::vector<ChildProcess> still;
      for (ChildProcess& child : running) {
        if (!child.ended()) still.push_back(std::move(child));
      }
      running.swap(still);
      for (; next != tasks.numbers.end() && std::ssize(running) < processes_; ++next) {
        running.emplace_back(
            std::vector<std::string>{"bash", tasks.folder + "/task.sh", tasks.kind, std::to_string(*next)},
            tasks.folder + "/" + tasks.kind + "-" + std::to_string(*next) + ".sh.log");
      }
      if (pause % kReportEvery == 0) report(tasks);
      std::this_thread::sleep_for(kPause);
    }
  }

 private:
  int processes_;
};

}  // namespace

std::unique_ptr<Engine> make_local_engine(std::unique_ptr<Store> store, const EngineOptions& options, int processes) {
  return std::make_unique<LocalEngine>(std::move(store), options, processes);
}

}  // namespace vesalius
