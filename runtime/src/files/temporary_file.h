// This file makes temporary files beside the files that they will replace, and removes those that were left
// behind. They are named ".NAME.RANDOM.sunbeam-tmp". With SUNBEAM_PORTABLE none can be told to be left
// behind.
#pragma once

#include <memory>
#include <string>

namespace sunbeam {
inline namespace v1 {

// Is empty at first and removed at the end. While an object lives it holds a lock on its file, so that others
// see that it is in use.
class TemporaryFile {
 public:
  // Makes a file beside `target` for bytes that will replace it. Removes what killed programs left there for
  // the same target. Throws Error naming `target`.
  explicit TemporaryFile(const std::string& target);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return *path_; }

  // Replaces the target by this file, with the target's owner and permissions; what is in it is on the disk
  // then. Returns false with errno where that cannot be done.
  bool replace_target();

 private:
  std::string target_;
  std::unique_ptr<const std::string> path_;
  int descriptor_ = -1;
};

// Gives the file at `path` the permissions of the file at `like`, and its owner where that is allowed. The
// group has none where the file cannot be given to it. Does nothing where there is no file at `like`.
bool copy_access(const std::string& path, const std::string& like);

}  // namespace v1
}  // namespace sunbeam
