// This file holds the end of `sunbeam bake` and `sunbeam merge`, and what they say of it on stderr.
#pragma once

#include <string>

#include "bake/cli/progress.h"
#include "bake/jobs/finish_bake.h"

namespace sunbeam {

// Measures the table's error.
VerifyReport measure_error(FinishedBake& table, int points, int threads, ProgressForm form);

// Writes the table.
void save(const FinishedBake& table, const std::string& path);

// Returns the exit code of a bake that wrote this table: 0, or 1 if it misses what the recipe allows. It then
// says so, with `advice` behind.
int verdict(const std::string& path, const Recipe& recipe, const VerifyReport& report,
            const std::string& advice = "");

}  // namespace sunbeam
