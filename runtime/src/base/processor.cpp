#include "sunbeam/detail/processor.h"

#include <cstdlib>
#include <string>
#include <string_view>

#include "sunbeam/core/error.h"

namespace sunbeam {
inline namespace v1 {

bool baseline_is_forced() {
  const char* const found = std::getenv("SUNBEAM_KERNELS");
  const std::string_view wish = found ? found : "";
  if (wish != "" && wish != "fastest" && wish != "baseline")
    throw Error("environment variable SUNBEAM_KERNELS: found '" + std::string(wish) +
                "'; allowed are 'fastest' and 'baseline'");
  return wish == "baseline";
}

}  // namespace v1
}  // namespace sunbeam
