// This file says where the scales of a snake lie, for scale_height_map(): hexagons over back and sides, wide
// scutes across the belly; on the head large shields. Places are in scale widths, x from the middle of the
// belly around the body, y towards the head.
#pragma once

#include <vector>

#include "sunbeam/detail/warp.h"

namespace sunbeam {

// Describes a cell of a power diagram (Aurenhammer 1987): the places whose squared distance to the site, less
// its weight, is the smallest.
struct ScaleSite {
  Point2 center;
  double half_length = 0;  // a site is a segment along x; 0: a point
  double weight = 0;       // the larger, the larger the cell: r^2 acts like a disc of the radius r
  Point2 in_scale = {};    // `center` less a place that all sites of one scale share
};

inline constexpr int kMinSnakeColumns = 12, kMaxSnakeColumns = 400;

// Returns the scales of the body. Both functions are for a tile `columns` wide, the whole girth, and `rows` *
// sqrt(3)/2 high; rows is even. There is one scute for every two rows of hexagons.
std::vector<ScaleSite> snake_body_sites(int columns, int rows);
// Returns the scales of the head: one unit of v, from the nape at y = 0. Shields lie from behind the head's
// widest place to the snout, where make_snake() has them; around them are the scales of the body, so that the
// tile continues the body's and repeats.
std::vector<ScaleSite> snake_head_sites(int columns, int rows);

}  // namespace sunbeam
