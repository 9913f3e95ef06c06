// This file does what follows the last block of a bake, wherever the blocks are: it measures the table's
// error and writes the table.
#pragma once

#include <functional>
#include <string>

#include "bake/blocks/job.h"
#include "bake/check/verify.h"

namespace sunbeam {

inline constexpr int kCheckPoints = 250;  // of the error that a table carries

class FinishedBake {
 public:
  // `blocks` must have all blocks of the job. They, the recipe and the job must outlive this.
  FinishedBake(const Recipe& recipe, const BakeJob& job, const Blocks& blocks);

  // Stores the figures of `sunbeam verify TABLE --points POINTS` in the table, and returns them.
  VerifyReport measure_error(int points, int threads, std::function<void(double fraction)> on_progress);

  // Writes the table. An .exr is in memory for some nodes at a time only.
  void save(const std::string& path) const;

  const std::map<std::string, std::string>& info() const { return table_.head().info; }

 private:
  const Recipe& recipe_;
  TableView table_;
};

}  // namespace sunbeam
