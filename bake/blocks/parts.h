// This file joins the parts of a bake that was dealt out to shards.
#pragma once

#include "bake/blocks/journal.h"

namespace sunbeam {

// Gives access to the blocks of all parts, as Blocks says.
class Parts : public Blocks {
 public:
  // Opens the parts. Throws Error naming parts that cannot be read, are of different bakes or of another
  // version of the tool, or are the same shard, and shards that are missing.
  explicit Parts(const std::vector<std::string>& paths);

  const BakeIdentity& identity() const { return parts_.front()->identity(); }

  // Throws Error naming the first part that does not have all blocks of its shard.
  void require_whole(const BakeJob& job);

  bool has(std::size_t task) const override { return part(task).has(task); }
  BlockSummary summary(std::size_t task) const override { return part(task).summary(task); }
  std::string values(std::size_t task) const override { return part(task).values(task); }

 private:
  const Journal& part(std::size_t task) const;

  std::vector<std::unique_ptr<Journal>> parts_;  // by shard
  std::vector<TaskRange> ranges_;
};

}  // namespace sunbeam
