// This file holds the end of `sunbeam bake` and `sunbeam merge`, and what they say of it on stderr.
#pragma once

#include <string>

#include "bake/cli/progress.h"
#include "bake/jobs/finish_bake.h"

namespace sunbeam {

// Measures the table's error. Returns true if it is within the recipe's tolerances.
bool measure_error(FinishedBake& table, const Recipe& recipe, int points, int threads, ProgressForm form);

// Writes the table.
void save(const FinishedBake& table, const std::string& path);

}  // namespace sunbeam
