// A bake in pieces: whatever runs where, the table has the bits of a bake in one go.
#include <fstream>

#include "bake/blocks/run.h"
#include "bake/check/verify.h"
#include "sunbeam/detail/file.h"
#include "sunbeam/table_io.h"
#include "tests/accuracy/support.h"

namespace sunbeam {
namespace {

constexpr const char* kMaterial =
    "[material]\nroughness = 0.2\nfilm_thickness_nm = 300\nbase_ior = 1.4\nabsorption_per_nm = 0.1\n"
    "pigment_thickness_nm = 2\n";
constexpr const char* kGrid =
    "[grid]\nfilm_thickness_nm = [200, 260, 330, 400, 480]\nbase_ior = [1.2, 1.4, 1.6]\n"
    "absorption_per_nm = [0.1, 0.3]\n";

struct Kind {
  const char* name;
  const char* text;
};

const Kind kKinds[] = {
    {"walked", "[table]\nencoding = \"dense\"\nangles = 4\n[accuracy]\nnoise = 0.2\n"},
    {"solved", "scattering_per_nm = 0.2\nanisotropy = 0.3\n[table]\nangles = 4\nazimuths = 3\n"},
    {"factored", "[table]\nencoding = \"factored\"\nangles = 4\n[accuracy]\nnoise = 0.02\n"},
    {"product",
     "absorption_path = \"product\"\n[table]\nencoding = \"factored\"\nangles = 4\n[accuracy]\nnoise = "
     "0.02\n"},
};

class Blocks : public testing::TestWithParam<Kind> {
 protected:
  Blocks()
      : recipe_(parse_recipe(std::string(kMaterial) + with_grid(GetParam().text), GetParam().name)),
        job_(make_job(recipe_, encodings_of(recipe_).front(), 1)) {}

  // [grid] goes between [material] and what follows it.
  static std::string with_grid(const std::string& text) {
    const auto table = text.find("[table]");
    return text.substr(0, table) + kGrid + text.substr(table);
  }

  Table table_of(const BlocksInMemory& blocks) const {
    std::optional<Table> room;
    return job_->table(blocks).whole(room);
  }

  Recipe recipe_;
  std::unique_ptr<BakeJob> job_;
};

TEST_P(Blocks, ShardsCoverEveryTaskOnceAndCostAboutTheSame) {
  for (const int shards : {1, 2, 3, 7, 16}) {
    std::size_t next = 0;
    double total = 0, most = 0, largest_task = 0;
    for (int k = 0; k < shards; ++k) {
      const TaskRange range = shard_of(*job_, k, shards);
      EXPECT_EQ(range.first, next);
      next = range.end;
      double cost = 0;
      for (std::size_t task = range.first; task < range.end; ++task) {
        cost += job_->cost(task);
        largest_task = std::max(largest_task, job_->cost(task));
      }
      total += cost;
      most = std::max(most, cost);
    }
    EXPECT_EQ(next, job_->tasks());
    EXPECT_LE(most, total / shards + largest_task) << shards;
  }
}

// In three pieces, the last first, by other numbers of threads.
TEST_P(Blocks, PiecesGiveTheBitsOfTheWhole) {
  const Table whole = bake_table(recipe_, {.seed = 1, .threads = 1, .on_progress = {}});
  BlocksInMemory blocks(job_->tasks());
  for (const int k : {2, 0, 1})
    EXPECT_TRUE(run_tasks(*job_, shard_of(*job_, k, 3), blocks, {k == 1 ? 1 : 2, {}, {}}));
  EXPECT_TRUE(table_of(blocks) == whole);
}

TEST_P(Blocks, AStoppedRunGoesOn) {
  BlocksInMemory blocks(job_->tasks());
  int asked = 0;
  EXPECT_FALSE(run_tasks(*job_, {0, job_->tasks()}, blocks, {1, {}, [&] { return ++asked > 3; }}));
  std::size_t done = 0;
  for (std::size_t task = 0; task < job_->tasks(); ++task) done += blocks.has(task);
  EXPECT_GT(done, 0u);
  EXPECT_LT(done, job_->tasks());
  double last = 0;
  std::size_t calls = 0;
  const auto on_progress = [&](const BakeProgress& p) {
    EXPECT_GT(p.fraction, last);
    EXPECT_GT(p.resumed, 0);
    last = p.fraction;
    ++calls;
  };
  EXPECT_TRUE(run_tasks(*job_, {0, job_->tasks()}, blocks, {2, on_progress, {}}));
  EXPECT_EQ(calls, job_->tasks() - done);
  EXPECT_EQ(last, 1);
  EXPECT_TRUE(table_of(blocks) == bake_table(recipe_, {}));
}

// Never in memory as a whole, yet the same file and the same error.
TEST_P(Blocks, AStreamedTableIsTheSame) {
  BlocksInMemory blocks(job_->tasks());
  run_tasks(*job_, {0, job_->tasks()}, blocks, {});
  const TableView streamed = job_->table(blocks);
  if (streamed.is_in_memory()) return;  // factored tables are small
  const Table whole = table_of(blocks);
  const std::string path = testing::TempDir() + "/streamed.exr";
  save_table_exr(streamed, path);
  EXPECT_TRUE(read_file(path) == table_exr_bytes(whole));
  EXPECT_TRUE(load_table_exr(path) == whole);

  VerifySettings settings;
  settings.points = 8;
  settings.tolerance_median = 0.2;
  const auto a = verify(streamed, settings).points, b = verify(whole, settings).points;
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].error, b[k].error) << k;
    EXPECT_EQ(a[k].albedo, b[k].albedo) << k;
    EXPECT_EQ(a[k].reciprocity, b[k].reciprocity) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Blocks, testing::ValuesIn(kKinds),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace sunbeam
