#include "bake/jobs/work_folder.h"

#include <filesystem>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/hash.h"

namespace sunbeam {
namespace {

namespace fs = std::filesystem;

// Beside the file that a link leads to, from where a part can be moved into place. Names that leave no room
// for the ending are cut short and told apart by a hash.
std::string work_path(const std::string& output) {
  constexpr std::size_t kLongest = 250, kCut = 200, kHash = 16;
  const OutputTarget target = output_target(output);
  if (target.is_stream) return output + ".work";
  const fs::path path = target.path;
  std::string name = path.filename().string();
  if (name.size() > kLongest) name = name.substr(0, kCut) + "." + content_hash(name).substr(0, kHash);
  return (path.parent_path() / (name + ".work")).string();
}

}  // namespace

WorkFolder::WorkFolder(const std::string& output, bool resume) : path_(work_path(output)) {
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
