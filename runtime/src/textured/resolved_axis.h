// This file finds how many nodes an axis needs, by the error between them.
#pragma once

#include <functional>
#include <vector>

#include "sunbeam/detail/axis.h"

namespace sunbeam {
inline namespace v1 {

// Returns `axis` with nodes even in its coordinate from one end to the other. There are at least
// `first` intervals, doubled until halfway between nodes `error(expected, found)` is at most `most_error`
// everywhere, but no more than `most`. `sample` evaluates what is interpolated.
using Sampled = std::vector<double>;
Axis resolved_axis(Axis axis, int first, int most, double most_error,
                   const std::function<Sampled(double)>& sample,
                   const std::function<double(const Sampled&, const Sampled&)>& error);

}  // namespace v1
}  // namespace sunbeam
