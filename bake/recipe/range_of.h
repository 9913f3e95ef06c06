// This file hands the allowed interval of a material key to the reader of TOML files.
#pragma once

#include <string_view>

#include "runtime/config/config.h"
#include "sunbeam/material.h"

namespace sunbeam {

inline Range range_of(std::string_view key) {
  const Interval allowed = allowed_interval(key);
  return {allowed.low, allowed.high};
}

}  // namespace sunbeam
