// The folder OUTPUT.work keeps what an unfinished bake has done so far. It holds one journal an encoding, and
// stands beside the file that OUTPUT leads to through symbolic links.
#pragma once

#include <string>

#include "bake/recipe/recipe.h"

namespace sunbeam {

class WorkFolder {
 public:
  // Creates the folder, or takes up one that is there. Throws Error if it is there and `resume` is false, and
  // if it cannot be created.
  WorkFolder(const std::string& output, bool resume);

  const std::string& path() const { return path_; }

  std::string journal_path(const std::string& encoding) const { return path_ + "/" + encoding + ".blocks"; }

  // Removes the folder with what a bake puts there, and nothing else.
  void remove();

 private:
  std::string path_;
};

}  // namespace sunbeam
