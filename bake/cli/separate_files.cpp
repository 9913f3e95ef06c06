#include "bake/cli/separate_files.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <optional>
#include <tuple>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"

namespace sunbeam {
namespace {

namespace fs = std::filesystem;

// The inode of a file; of one that is not there yet the inode of its folder, and its name.
using Identity = std::tuple<dev_t, ino_t, std::string>;

struct NamedFile {
  std::string name;
  std::optional<Identity> identity;  // none of what is no file

  bool is_same(const NamedFile& other) const { return identity && identity == other.identity; }
};

std::optional<Identity> identity_of(const struct stat& status) {
  if (!S_ISREG(status.st_mode)) return std::nullopt;
  return Identity{status.st_dev, status.st_ino, ""};
}

NamedFile input(const std::string& path) {
  struct stat status {};
  return {path, ::stat(path.c_str(), &status) == 0 ? identity_of(status) : std::nullopt};
}

NamedFile output(const std::string& path) {
  const OutputTarget target = output_target(path);
  if (target.is_stream) return {path, std::nullopt};
  struct stat status {};
  if (::stat(target.path.c_str(), &status) == 0) return {path, identity_of(status)};
  const fs::path file = target.path;
  const std::string folder = file.has_parent_path() ? file.parent_path().string() : ".";
  if (::stat(folder.c_str(), &status) != 0) return {path, std::nullopt};
  return {path, Identity{status.st_dev, status.st_ino, file.filename().string()}};
}

NamedFile standard_output() {
  struct stat status {};
  return {"standard output", ::fstat(STDOUT_FILENO, &status) == 0 ? identity_of(status) : std::nullopt};
}

}  // namespace

void require_separate(const std::vector<std::string>& inputs, const std::vector<std::string>& outputs) {
  std::vector<NamedFile> written{standard_output()};
  for (const std::string& path : outputs) {
    if (path.empty()) continue;
    NamedFile file = output(path);
    for (const NamedFile& other : written)
      if (file.is_same(other)) throw Error(path + ": is the same file as another output, " + other.name);
    written.push_back(std::move(file));
  }
  for (const std::string& path : inputs) {
    const NamedFile read = input(path);
    for (const NamedFile& file : written)
      if (file.is_same(read))
        throw Error(file.name + ": cannot write: it is an input of this command, " + path);
  }
}

}  // namespace sunbeam
