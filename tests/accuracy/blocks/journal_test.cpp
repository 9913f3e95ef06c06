// Work and parts of another version of the tool: the one difference that the command line cannot make.
#include <filesystem>

#include "bake/base/version.h"
#include "bake/blocks/parts.h"
#include "sunbeam/core/error.h"
#include "tests/accuracy/support.h"
#include "tests/support/error_of.h"

namespace sunbeam {
namespace {

using test::error_of;

const BakeIdentity kThis{kToolVersion, "hash", "[material]\n", "dense", 1, 0, 1};

BakeIdentity of_another_version() {
  BakeIdentity identity = kThis;
  identity.version = "0.0.0";
  return identity;
}

class OfAnotherVersion : public testing::Test {
 protected:
  OfAnotherVersion() : path_(testing::TempDir() + "of_another_version.blocks") {
    std::filesystem::remove(path_);
    Journal::open(path_, of_another_version())->add(0, {{1, 0.5}, "values"});
  }
  ~OfAnotherVersion() override { std::filesystem::remove(path_); }

  std::string path_;
};

TEST_F(OfAnotherVersion, WorkIsNotContinued) {
  const auto message = error_of([&] { Journal::open(path_, kThis); });
  EXPECT_EQ(message,
            path_ + ": holds the work of another bake: the tool's version 0.0.0 against " + kToolVersion);
  EXPECT_EQ(Journal::read(path_)->blocks(), 1U);
  EXPECT_EQ(Journal::open(path_, of_another_version())->values(0), "values");
}

TEST_F(OfAnotherVersion, PartsAreNotMerged) {
  EXPECT_EQ(error_of([&] { Parts parts({path_}); }),
            path_ + ": is of version 0.0.0 of the tool; this is " + kToolVersion);
}

}  // namespace
}  // namespace sunbeam
