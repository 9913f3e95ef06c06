// OUTPUT.work: what an unfinished bake has done so far. It holds the plan and one journal an encoding.
#pragma once

#include <optional>
#include <string>

#include "bake/blocks/journal.h"
#include "bake/jobs/plan.h"

namespace sunbeam {

class WorkFolder {
 public:
  // Creates the folder, or takes up one that is there. Throws Error if it is there and `resume` is false, and
  // if it cannot be created.
  WorkFolder(const std::string& output, bool resume);

  const std::string& path() const { return path_; }

  // The plan, if one has been saved. Throws Error if it is of another recipe, seed or version.
  std::optional<Plan> saved_plan(const Recipe& recipe, std::uint64_t seed) const;
  void save(const Plan& plan, const Recipe& recipe, std::uint64_t seed) const;

  std::string journal_path(const std::string& encoding) const { return path_ + "/" + encoding + ".blocks"; }

  // Removes the folder with what a bake puts there, and nothing else.
  void remove();

 private:
  std::string plan_path() const { return path_ + "/plan.toml"; }

  std::string path_;
};

}  // namespace sunbeam
