// PNG files: heights, fields and what is compared.
#include "bake/compare/rendering.h"
#include "runtime/tracer/png_source.h"
#include "tests/fuzz/pictures.h"
#include "tests/fuzz/support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunbeam;
  test::fuzz(data, size, [](const std::string& bytes) {
    if (is_png(bytes)) test::require_heights(parse_height_map(bytes, "a.png"));
  });
  return test::fuzz(data, size, [](const std::string& bytes) {
    if (is_png(bytes)) test::require_picture(parse_rendering(bytes, "a.png").picture.mean);
  });
}
