// Runs the tasks of a bake on all cores and says how far it is.
#pragma once

#include <functional>

#include "bake/blocks/job.h"

namespace sunbeam {

// Takes finished blocks in. add() is called by one thread at a time.
class BlockStore : public Blocks {
 public:
  virtual void add(std::size_t task, const Block& block) = 0;
};

class BlocksInMemory : public BlockStore {
 public:
  explicit BlocksInMemory(std::size_t tasks) : blocks_(tasks), done_(tasks) {}

  void add(std::size_t task, const Block& block) override {
    blocks_[task] = block;
    done_[task] = 1;
  }
  bool has(std::size_t task) const override { return done_[task] != 0; }
  BlockSummary summary(std::size_t task) const override { return blocks_[task].summary; }
  std::string values(std::size_t task) const override { return blocks_[task].values; }

 private:
  std::vector<Block> blocks_;
  std::vector<char> done_;
};

// Returns the tasks of shard `shard` (from 0) of `shards`: they follow one another, and shards cost about the
// same.
TaskRange shard_of(const BakeJob& job, int shard, int shards);

struct BakeProgress {
  std::size_t done, total;   // tasks
  double fraction, resumed;  // of the cost: done, and already done at the start
  double worst_error;        // BlockSummary, of all blocks
};

struct TaskSettings {
  int threads = 0;                                       // 0: all
  std::function<void(const BakeProgress&)> on_progress;  // after each task, one thread at a time
  std::function<bool()> should_stop;                     // asked before each task
};

// Runs the tasks of `range` whose blocks `store` lacks. Returns false if it was stopped before the end.
bool run_tasks(BakeJob& job, const TaskRange& range, BlockStore& store, const TaskSettings& settings);

}  // namespace sunbeam
