// Tables as OpenVDB: whatever loads has sound values wherever it is looked up.
#include "sunbeam/table_vdb.h"
#include "tests/fuzz/support.h"
#include "tests/fuzz/table_look_ups.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunbeam;
  return test::fuzz(data, size,
                    [](const std::string& bytes) { test::look_up(parse_table_vdb(bytes, "t"), bytes); });
}
