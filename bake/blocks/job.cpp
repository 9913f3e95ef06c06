#include "bake/blocks/job.h"

namespace sunbeam {

std::uint64_t total_walks(const BakeJob& job, const Blocks& blocks) {
  std::uint64_t walks = 0;
  for (std::size_t task = 0; task < job.tasks(); ++task) walks += blocks.summary(task).walks;
  return walks;
}

}  // namespace sunbeam
