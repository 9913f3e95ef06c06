#include "bake/base/parallel_tasks.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <mutex>
#include <thread>

namespace sunbeam {

void run_parallel_tasks(std::size_t count, int threads,
                        const std::function<void(double fraction)>& on_progress,
                        const std::function<void(std::size_t k)>& task) {
  const std::size_t limit =
      threads > 0 ? static_cast<std::size_t>(threads) : std::thread::hardware_concurrency();
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, limit);
  std::mutex mutex;
  std::size_t done = 0;
  const auto each = [&](std::size_t k) {
    task(k);
    if (!on_progress) return;
    const std::lock_guard lock(mutex);
    on_progress(static_cast<double>(++done) / static_cast<double>(count));
  };
  // Tasks are long: none is tied to another, so that no thread waits for a run of them.
  tbb::parallel_for(std::size_t{0}, count, each, tbb::simple_partitioner());
}

}  // namespace sunbeam
