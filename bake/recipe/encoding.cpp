#include "bake/recipe/encoding.h"

#include "bake/live/adding_doubling/slab_solver.h"

namespace sunbeam {

bool has_solution(const Material& material) { return SlabSolver::solves(material); }

}  // namespace sunbeam
