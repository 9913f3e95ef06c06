// Parts of bakes: what is read has its blocks, within the file, and joins with itself alone.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>

#include "bake/blocks/parts.h"
#include "tests/fuzz/support.h"

namespace {

// A file in memory, which journals read by its path.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& bytes) : descriptor_(::memfd_create("part", MFD_CLOEXEC)) {
    if (descriptor_ < 0 ||
        ::write(descriptor_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
      std::abort();
  }
  ~MemoryFile() { ::close(descriptor_); }
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunbeam;
  return test::fuzz(data, size, [&](const std::string& bytes) {
    const MemoryFile file(bytes);
    const auto journal = Journal::read(file.path());
    std::size_t found = 0, held = 0;
    for (std::size_t task = 0; task < 1000; ++task)
      if (journal->has(task)) {
        ++found;
        held += journal->values(task).size();
        if (!(journal->summary(task).worst_error >= 0)) std::abort();
      }
    if (found > journal->blocks() || held + journal->damaged_bytes() > size) std::abort();
    Parts({file.path()});
  });
}
