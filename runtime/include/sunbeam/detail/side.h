// This file names the sides of a film.
#pragma once

namespace sunbeam {
inline namespace v1 {

enum class Side { outside, inside };
constexpr Side opposite(Side side) { return side == Side::outside ? Side::inside : Side::outside; }

}  // namespace v1
}  // namespace sunbeam
