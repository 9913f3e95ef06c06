// This file says which wavelengths are visible light.
#pragma once

namespace sunbeam {

inline constexpr double kShortestVisibleNm = 380;
inline constexpr double kLongestVisibleNm = 780;

}  // namespace sunbeam
