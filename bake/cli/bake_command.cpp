#include <filesystem>
#include <optional>

#include "bake/base/version.h"
#include "bake/blocks/journal.h"
#include "bake/cli/commands.h"
#include "bake/cli/console.h"
#include "bake/cli/finish.h"
#include "bake/cli/interrupt.h"
#include "bake/cli/separate_files.h"
#include "bake/dense/lobes.h"
#include "bake/jobs/bake.h"
#include "bake/jobs/preview.h"
#include "bake/jobs/work_folder.h"
#include "sunbeam/core/error.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/table_vdb.h"

namespace sunbeam {
namespace {

constexpr int kPreviewPoints = 16;
constexpr int kInterrupted = 130;  // as a shell reports Ctrl-C

void announce(const Recipe& recipe, Encoding encoding) {
  if (encoding == Encoding::factored) {
    message("{}: factored, {} cosines, {} base IORs, {} absorptions, values by shared walks", recipe.name,
            recipe.table.angles, recipe.grid[1].size(), recipe.grid[2].size());
    return;
  }
  message("{}: dense, {} parameter nodes, {} x {} cosines, {} azimuths, values by {}", recipe.name,
          recipe.grid[0].size() * recipe.grid[1].size() * recipe.grid[2].size(), recipe.table.angles,
          recipe.table.angles, recipe.table.azimuths,
          is_solved(recipe) ? "adding-doubling" : name_of(recipe.accuracy.estimator));
}

class BakeCommand {
 public:
  explicit BakeCommand(const BakeOptions& options)
      : options_(options),
        form_(progress_form(options.progress)),
        recipe_(load_recipe(options.recipe, options.overrides)) {
    require_separate({options.recipe}, {options.output});
    require_wide_lobes(recipe_);
    if (options.preview) recipe_ = preview_of(recipe_);
    for (const Encoding encoding : encodings_of(recipe_)) require_reasonable_size(recipe_, encoding);
    require_writable(options.output);
    work_.emplace(options.output, options.resume);
  }

  int run() { return options_.shards > 0 ? bake_part() : bake_table(); }

 private:
  BakeIdentity identity_of(Encoding encoding) const {
    const int shards = std::max(1, options_.shards), shard = options_.shards > 0 ? options_.shard - 1 : 0;
    return {kToolVersion, recipe_.hash, recipe_.text, name_of(encoding), options_.seed, shard, shards};
  }

  std::unique_ptr<Journal> journal_of(Encoding encoding) const {
    auto journal = Journal::open(work_->journal_path(name_of(encoding)), identity_of(encoding));
    if (journal->damaged_bytes() > 0)
      message("{}: its last {} bytes are no whole block and are baked again", journal->path(),
              journal->damaged_bytes());
    return journal;
  }

  // False if interrupted.
  bool run_blocks(BakeJob& job, const TaskRange& range, Journal& journal) {
    const Interrupt interrupt;
    if (journal.blocks() > 0) message("resumed with {} of {} blocks", journal.blocks(), range.size());
    Progress progress("bake", "blocks", static_cast<double>(range.size()), form_);
    TaskSettings settings{options_.threads, {}, [&] { return interrupt.requested(); }};
    settings.on_progress = [&](const BakeProgress& p) { progress(p); };
    const bool done = run_tasks(job, range, journal, settings);
    journal.sync();
    if (!done)
      message("interrupted: {} of {} blocks are in {}; continue with --resume", journal.blocks(),
              range.size(), work_->path());
    return done;
  }

  // A whole bake in one encoding.
  struct Attempt {
    std::unique_ptr<BakeJob> job;
    std::unique_ptr<Journal> journal;
    std::unique_ptr<FinishedBake> table;
    VerifyReport report;
  };

  // None if interrupted.
  std::optional<Attempt> attempt(Encoding encoding) {
    announce(recipe_, encoding);
    Attempt a{make_job(recipe_, encoding, options_.seed), journal_of(encoding), {}, {}};
    if (!run_blocks(*a.job, {0, a.job->tasks()}, *a.journal)) return std::nullopt;
    a.table = std::make_unique<FinishedBake>(recipe_, *a.job, *a.journal);
    a.report =
        measure_error(*a.table, options_.preview ? kPreviewPoints : kCheckPoints, options_.threads, form_);
    return a;
  }

  // Saves the first table that meets the tolerances, or the best; a preview tries one encoding.
  int bake_table() {
    const auto encodings = encodings_of(recipe_);
    const VerifySettings settings = verify_settings_of(recipe_);
    std::optional<Attempt> best;
    for (const Encoding encoding : encodings) {
      auto next = attempt(encoding);
      if (!next) return kInterrupted;
      const bool good = within_tolerance(next->report, settings);
      if (encodings.size() > 1)
        message("encoding auto: {} {} the tolerances (median {:g}, p99 {:g})", name_of(encoding),
                good ? "is the smallest that meets" : "misses", settings.tolerance_median,
                settings.tolerance_p99);
      if (!best || worst_share(next->report, settings) < worst_share(best->report, settings))
        best = std::move(next);
      if (good || options_.preview) break;
    }
    save(*best->table, options_.output);
    work_->remove();
    return options_.preview ? 0 : verdict(options_.output, recipe_, best->report);
  }

  // Whether the output is this part and whole.
  bool is_finished(const BakeIdentity& identity, const TaskRange& range) const {
    if (!std::filesystem::is_regular_file(options_.output)) return false;
    try {
      const auto part = Journal::read(options_.output);
      return part->identity().text() == identity.text() && part->blocks() == range.size() &&
             part->damaged_bytes() == 0;
    } catch (const Error&) {
      return false;  // no part: it is baked
    }
  }

  int bake_part() {
    const Encoding encoding = encodings_of(recipe_).front();
    announce(recipe_, encoding);
    const auto job = make_job(recipe_, encoding, options_.seed);
    const TaskRange range = shard_of(*job, options_.shard - 1, options_.shards);
    if (options_.resume && is_finished(identity_of(encoding), range)) {
      message("{}: is there already", options_.output);
      work_->remove();
      return 0;
    }
    const auto journal = journal_of(encoding);
    if (!run_blocks(*job, range, *journal)) return kInterrupted;
    move_into_place(journal->path(), options_.output);
    work_->remove();
    message("{}: part {} of {}, {} blocks; join the parts with sunbeam merge", options_.output,
            options_.shard, options_.shards, range.size());
    return 0;
  }

  const BakeOptions& options_;
  ProgressForm form_;
  Recipe recipe_;
  std::optional<WorkFolder> work_;
};

}  // namespace

int run_bake(const BakeOptions& options) {
  if (options.shards == 0) require_table_extension(options.output);
  return BakeCommand(options).run();
}

}  // namespace sunbeam
