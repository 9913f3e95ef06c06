// Tables in OpenVDB form, whose hashes are not checked here.
#include <cmath>
#include <cstdlib>

#include "sunbeam/table_vdb.h"
#include "tests/fuzz/support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunbeam;
  return test::fuzz(data, size, [](const std::string& bytes) {
    const Table table = parse_table_vdb(bytes, "t");
    for (const NdArray* array : table.arrays())
      for (const float value : array->values())
        if (!std::isfinite(value)) std::abort();
  });
}
