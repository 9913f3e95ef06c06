// This file makes a coiled snake that rests, its head raised from the middle of the coil.
#pragma once

#include "runtime/tracer/mesh.h"

namespace sunbeam {

struct SnakeShape {
  double body_radius = 0.25;  // half the width of the body where it is thickest
  double turns = 2.5;         // of the coil on the ground, 1 to 6, rounded to sixteenths
  int resolution = 128;  // vertices around the body, 16 to 1024; half as many to the same length along it
};

// The snake lies about the z axis, on the plane z = 0, and looks along -y. Both parts are closed; winding and
// unit normals point outwards. u runs once around the body, from the middle of the belly over the right side
// to the back (u = 1/2), and starts again there. v runs from the tip of the tail to the snout, and a step
// along the body changes it by its length over the girth: a unit of v is as long as one of u but at both
// ends, so that scales are not stretched; their number around the body stays. v = 0 is the nape: the body has
// v < 0, the head 0 <= v < 1. The eyes are two spheres sunk into the head. Each has one (u, v) only, and so
// no scales.
struct Snake {
  Mesh skin, eyes;
};
Snake make_snake(const SnakeShape& shape);
Mesh snake_mesh(const SnakeShape& shape);  // both parts in one

// Holds a point of the centreline from tail to snout with the half-width of the body, body_radius = 1.
// Clearances are told from it.
struct SnakePoint {
  Vec3 position;
  double arc = 0;  // length from the tip of the tail
  double half_width = 0;
};
std::vector<SnakePoint> snake_centerline(const SnakeShape& shape, int points);

}  // namespace sunbeam
