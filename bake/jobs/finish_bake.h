// What follows the last block of a bake, wherever the blocks are: measure the table's error, write it.
#pragma once

#include <functional>
#include <string>

#include "bake/blocks/job.h"
#include "bake/check/verify.h"

namespace sunbeam {

inline constexpr int kCheckPoints = 250;  // of the error that a table carries

class FinishedBake {
 public:
  // `blocks` must have all of the job's, and outlive this, as recipe and job must.
  FinishedBake(const Recipe& recipe, const BakeJob& job, const Blocks& blocks);

  // Stores the figures of `sunbeam verify TABLE --points POINTS` in the table, and returns them.
  VerifyReport measure_error(int points, int threads, std::function<void(double fraction)> on_progress);

  // .exr: in memory for some nodes only.
  void save(const std::string& path) const;

  const std::map<std::string, std::string>& info() const { return table_.head().info; }

 private:
  const Recipe& recipe_;
  TableView table_;
};

}  // namespace sunbeam
