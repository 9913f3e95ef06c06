#include "bake/jobs/work_folder.h"

#include <fmt/format.h>

#include <filesystem>

#include "bake/base/version.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTitle = "# Plan of a bake by sunbeam ";

std::string first_line(const Recipe& recipe, std::uint64_t seed) {
  return fmt::format("{}{}, recipe {}, seed {}\n", kTitle, kToolVersion, recipe.hash, seed);
}

}  // namespace

WorkFolder::WorkFolder(const std::string& output, bool resume) : path_(output + ".work") {
  std::error_code error;
  if (fs::exists(path_, error) && !fs::is_empty(path_, error) && !resume)
    throw Error(path_ +
                ": holds an unfinished bake; continue it with --resume, or delete the folder to start anew");
  fs::create_directory(path_, error);
  if (error) throw Error(path_ + ": cannot create the folder: " + error.message());
}

std::optional<Plan> WorkFolder::saved_plan(const Recipe& recipe, std::uint64_t seed) const {
  std::error_code ignored;
  if (!fs::exists(plan_path(), ignored)) return {};
  const std::string text = read_file(plan_path());
  const auto lines = split(text, '\n');
  if (lines.size() < 3 || lines[0] + "\n" != first_line(recipe, seed))
    throw Error(fmt::format("{}: holds the plan of another bake: found '{}'; expected '{}'", plan_path(),
                            lines[0], first_line(recipe, seed)));
  return Plan{parse_recipe(text, plan_path()), lines[1].substr(2)};
}

void WorkFolder::save(const Plan& plan, const Recipe& recipe, std::uint64_t seed) const {
  write_file_atomically(plan_path(),
                        first_line(recipe, seed) + "# " + plan.summary + "\n" + plan.recipe.text);
}

void WorkFolder::remove() {
  std::error_code ignored;
  fs::remove(plan_path(), ignored);
  for (const Encoding encoding : {Encoding::dense, Encoding::factored})
    fs::remove(journal_path(name_of(encoding)), ignored);
  fs::remove(path_, ignored);
}

}  // namespace sunbeam
