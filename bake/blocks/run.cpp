#include "bake/blocks/run.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <mutex>

#include "bake/base/parallel_tasks.h"

namespace sunbeam {
namespace {

class TaskRun {
 public:
  TaskRun(BakeJob& job, const TaskRange& range, BlockStore& store, const TaskSettings& settings)
      : job_(job), store_(store), settings_(settings), progress_{0, range.size(), 0, 0, 0} {
    for (std::size_t task = range.first; task < range.end; ++task) total_cost_ += job.cost(task);
    for (std::size_t task = range.first; task < range.end; ++task) {
      if (store.has(task))
        count(task);
      else
        missing_.push_back(task);
    }
    progress_.resumed = progress_.fraction;
  }

  bool run() {
    const auto groups = job_.groups();
    for (std::size_t group = 0; group < groups.size() && !stopped_; ++group) {
      const std::size_t end = group + 1 < groups.size() ? groups[group + 1] : job_.tasks();
      const auto from = std::lower_bound(missing_.begin(), missing_.end(), groups[group]);
      run_group({from, std::lower_bound(from, missing_.end(), end)});
    }
    return !stopped_;
  }

 private:
  void run_group(std::vector<std::size_t> tasks) {
    if (tasks.empty() || should_stop()) return;
    job_.prepare({tasks.front(), tasks.back() + 1}, settings_.threads);
    // The longest first: at the end no thread waits for one.
    std::ranges::sort(tasks, {}, [&](std::size_t task) { return std::pair(-job_.cost(task), task); });
    std::atomic<std::size_t> next = 0;
    run_parallel_tasks(tasks.size(), settings_.threads, {}, [&](std::size_t) {
      const std::size_t task = tasks[next++];
      if (should_stop()) return;
      const Block block = job_.run(task);
      const std::lock_guard lock(mutex_);
      store_.add(task, block);
      count(task);
      if (settings_.on_progress) settings_.on_progress(progress_);
    });
  }

  bool should_stop() {
    if (settings_.should_stop && settings_.should_stop()) stopped_ = true;
    return stopped_;
  }

  void count(std::size_t task) {
    ++progress_.done;
    done_cost_ += job_.cost(task);
    progress_.fraction = progress_.done == progress_.total ? 1 : done_cost_ / total_cost_;
    progress_.worst_error = std::max(progress_.worst_error, store_.summary(task).worst_error);
  }

  BakeJob& job_;
  BlockStore& store_;
  const TaskSettings& settings_;
  std::vector<std::size_t> missing_;
  double total_cost_ = 0, done_cost_ = 0;
  BakeProgress progress_;
  std::mutex mutex_;
  std::atomic<bool> stopped_ = false;
};

}  // namespace

TaskRange shard_of(const BakeJob& job, int shard, int shards) {
  double total = 0;
  for (std::size_t task = 0; task < job.tasks(); ++task) total += job.cost(task);
  // The first task whose middle lies beyond a share of the cost.
  const auto boundary = [&](int k) {
    double before = 0;
    std::size_t task = 0;
    for (; task < job.tasks() && k < shards; ++task) {
      if (before + job.cost(task) / 2 >= total * k / shards) break;
      before += job.cost(task);
    }
    return k < shards ? task : job.tasks();
  };
  return {boundary(shard), boundary(shard + 1)};
}

bool run_tasks(BakeJob& job, const TaskRange& range, BlockStore& store, const TaskSettings& settings) {
  return TaskRun(job, range, store, settings).run();
}

}  // namespace sunbeam
