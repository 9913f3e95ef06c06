#include "sunbeam/core/read_limit.h"

#include <gtest/gtest.h>

#include "tests/support/error_of.h"

namespace sunbeam {
namespace {

// Puts the usual limit back.
struct RaisedLimit {
  explicit RaisedLimit(std::uint64_t bytes) { set_read_limit(bytes); }
  ~RaisedLimit() { set_read_limit(0); }
};

TEST(ReadLimit, IsOneGigabyteAndFourTimesTheFile) {
  EXPECT_EQ(read_limit(0), 1000000000u);
  EXPECT_EQ(read_limit(250000000), 2000000000u);
}

TEST(ReadLimit, CanBeRaisedAndNotLowered) {
  const RaisedLimit raised(1500000000);
  EXPECT_EQ(read_limit(0), 1500000000u);
  EXPECT_EQ(read_limit(1000000000), 5000000000u);
}

TEST(ReadLimit, MessageSaysWhatAsksForHowMuch) {
  require_within_read_limit("image 'a.exr'", 1000000400, 100);
  EXPECT_EQ(test::error_of([] { require_within_read_limit("image 'a.exr'", 1000000401, 100); }),
            "image 'a.exr' asks for 1001 MB of memory; allowed for a file of this size: 1001 MB");
  EXPECT_EQ(test::error_of([] { require_within_read_limit("image 'a.exr'", 12600000000, 0); }),
            "image 'a.exr' asks for 12600 MB of memory; allowed for a file of this size: 1000 MB");
}

}  // namespace
}  // namespace sunbeam
