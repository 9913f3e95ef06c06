// This file runs independent tasks on a given number of threads and reports their progress.
#pragma once

#include <cstddef>
#include <functional>

namespace sunbeam {

// Calls task(k) for every k below `count`, in any order, on `threads` threads (0: all). on_progress, if any,
// gets the fraction done, rising to 1, one thread at a time. An exception of a task reaches the caller.
void run_parallel_tasks(std::size_t count, int threads,
                        const std::function<void(double fraction)>& on_progress,
                        const std::function<void(std::size_t k)>& task);

}  // namespace sunbeam
