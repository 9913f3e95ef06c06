// This file describes a bake as independent tasks. Each makes one block of values, with the same bits
// whatever runs before or beside it, in which process and on how many threads; the table is made of the
// blocks once all are there. So a bake may be killed and resumed, or dealt out to many machines.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sunbeam/detail/table_view.h"

namespace sunbeam {

struct BlockSummary {
  std::uint64_t walks = 0;
  double worst_error = 0;  // largest relative standard error of a value that the bake aims at
};

struct Block {
  BlockSummary summary;
  std::string values;  // bytes that the job alone understands
};

// Gives access to finished blocks by task. All functions may be called by many threads.
class Blocks {
 public:
  virtual ~Blocks() = default;
  virtual bool has(std::size_t task) const = 0;
  virtual BlockSummary summary(std::size_t task) const = 0;
  // Throws Error if the block cannot be read back.
  virtual std::string values(std::size_t task) const = 0;
};

struct TaskRange {
  std::size_t first, end;
  std::size_t size() const { return end - first; }
};

class BakeJob {
 public:
  virtual ~BakeJob() = default;

  virtual std::size_t tasks() const = 0;
  // Returns a rough forecast of the seconds that a core spends on a task. Its proportions say how far a bake
  // is; it depends on the recipe alone.
  virtual double cost(std::size_t task) const = 0;

  // Returns the first task of each group of tasks that share a preparation.
  virtual std::vector<std::size_t> groups() const { return {0}; }
  // Makes that preparation and is called before any of `tasks`, which are of one group. What was prepared
  // before may be forgotten.
  virtual void prepare(const TaskRange& /*tasks*/, int /*threads*/) {}

  // Makes the block of a task. It is safe to call beside other tasks of the same group.
  virtual Block run(std::size_t task) const = 0;

  // Returns the table made of all blocks; they and the job must outlive it.
  virtual TableView table(const Blocks& blocks) const = 0;
};

// Returns the walks of all blocks together; `job` tells how many there are.
std::uint64_t total_walks(const BakeJob& job, const Blocks& blocks);

}  // namespace sunbeam
