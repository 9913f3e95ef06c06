#pragma once

namespace sunbeam {

inline constexpr const char* kToolVersion = SUNBEAM_VERSION;

}  // namespace sunbeam
