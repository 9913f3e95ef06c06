#include "bake/jobs/work_folder.h"

#include <filesystem>

#include "sunbeam/core/error.h"

namespace sunbeam {
namespace {

namespace fs = std::filesystem;

}  // namespace

WorkFolder::WorkFolder(const std::string& output, bool resume) : path_(output + ".work") {
  std::error_code error;
  if (fs::exists(path_, error) && !fs::is_empty(path_, error) && !resume)
    throw Error(path_ +
                ": holds an unfinished bake; continue it with --resume, or delete the folder to start anew");
  fs::create_directory(path_, error);
  if (error) throw Error(path_ + ": cannot create the folder: " + error.message());
}

void WorkFolder::remove() {
  std::error_code ignored;
  for (const Encoding encoding : {Encoding::dense, Encoding::factored})
    fs::remove(journal_path(name_of(encoding)), ignored);
  fs::remove(path_, ignored);
}

}  // namespace sunbeam
