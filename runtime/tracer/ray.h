// A ray is a half-line in world space (z up, scene length units).
#pragma once

#include "sunbeam/core/vec.h"

namespace sunbeam {

struct Ray {
  Vec3 origin;
  Vec3 direction;  // unit
};

}  // namespace sunbeam
