// Radiance pictures as environments.
#include "runtime/tracer/radiance_hdr.h"
#include "tests/fuzz/pictures.h"
#include "tests/fuzz/support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunbeam;
  return test::fuzz(data, size, [](const std::string& bytes) {
    if (is_radiance_hdr(bytes)) test::require_environment(parse_environment_map(bytes, "a.hdr"));
  });
}
