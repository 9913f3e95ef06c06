// OpenVDB's own functions decide whether a block unpacks.
#include <openvdb/io/Compression.h>

#include <sstream>
#include <vector>

#include "runtime/src/vdb/vdb_blocks.h"

namespace sunbeam {
inline namespace v1 {

void require_unpacks(std::string_view packed, std::uint32_t compression, std::uint64_t bytes) {
  const auto size = static_cast<std::int64_t>(packed.size());
  std::string block(reinterpret_cast<const char*>(&size), sizeof size);
  block += packed;
  std::istringstream in(block);
  std::vector<char> unpacked(bytes);
  if (compression & kVdbBlosc)
    openvdb::io::bloscFromStream(in, unpacked.data(), bytes);
  else
    openvdb::io::unzipFromStream(in, unpacked.data(), bytes);
}

}  // namespace v1
}  // namespace sunbeam
