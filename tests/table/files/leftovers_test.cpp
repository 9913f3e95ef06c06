// What killed programs leave behind, and what the next one does about it.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "sunbeam/detail/file.h"
#include "tests/support/error_of.h"
#include "tests/table/support.h"

namespace sunbeam {
namespace {

using test::error_of;

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::UnorderedElementsAre;

namespace fs = std::filesystem;

// A program that is killed after half of a file.
void write_half_and_die(const std::string& path) {
  const pid_t child = ::fork();
  if (child == 0) {
    AtomicFile file(path);
    file.write("half");
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
}

TEST(Leftovers, AreRemovedByTheNextRunForTheSameFile) {
  const ScratchFolder folder;
  write_file_atomically(folder.file("f.exr"), "old");
  write_half_and_die(folder.file("f.exr"));
  ASSERT_EQ(folder.names().size(), 2u);
  for (const std::string& name : folder.names())
    if (name != "f.exr") {
      EXPECT_THAT(name, MatchesRegex("\\.f\\.exr\\.[a-z2-7]{12}\\.sunbeam-tmp"));
    }
  EXPECT_EQ(read_file(folder.file("f.exr")), "old");
  write_file_atomically(folder.file("other"), "x");  // of another file
  EXPECT_EQ(folder.names().size(), 3u);
  require_writable(folder.file("f.exr"));
  EXPECT_THAT(folder.names(), UnorderedElementsAre("f.exr", "other"));
}

TEST(Leftovers, OfLongNamesAndBehindLinks) {
  const ScratchFolder folder;
  ASSERT_EQ(::mkdir(folder.file("sub").c_str(), 0777), 0);
  const std::string longest(255, 'x');
  fs::create_symlink("sub/" + longest, folder.file("link"));
  write_half_and_die(folder.file("link"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.file("sub")), fs::directory_iterator()), 1);
  write_file_atomically(folder.file("link"), "whole");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.file("sub")), fs::directory_iterator()), 1);
  EXPECT_EQ(read_file(folder.file("sub/" + longest)), "whole");
}

TEST(Leftovers, FilesInUseAndOtherFilesStay) {
  const ScratchFolder folder;
  const std::vector<std::string> others = {
      ".f.sunbeam-tmp",                 // no random part
      ".f.abcdefabcdef.tmp",            // another ending
      ".f.ABCDEFABCDEF.sunbeam-tmp",    // other letters
      ".f.abcdef.sunbeam-tmp",          // too few
      ".f.g.abcdefabcdef.sunbeam-tmp",  // of the file f.g
      ".fabcdefabcdef.sunbeam-tmp",
      "f.abcdefabcdef.sunbeam-tmp",
  };
  for (const std::string& name : others) folder.write(name, "kept");
  ASSERT_EQ(::mkdir(folder.file(".f.aaaaaaaaaaaa.sunbeam-tmp").c_str(), 0777), 0);
  fs::create_symlink("f.exr", folder.file(".f.bbbbbbbbbbbb.sunbeam-tmp"));
  ASSERT_EQ(::mkfifo(folder.file(".f.cccccccccccc.sunbeam-tmp").c_str(), 0600), 0);
  folder.write(".f.dddddddddddd.sunbeam-tmp", "goes");
  AtomicFile writing(folder.file("f"));
  writing.write("first");
  write_file_atomically(folder.file("f"), "second");
  EXPECT_EQ(folder.names().size(), others.size() + 3 + 2);  // and f, and what is being written
  EXPECT_FALSE(fs::exists(folder.file(".f.dddddddddddd.sunbeam-tmp")));
  writing.keep();
  EXPECT_EQ(read_file(folder.file("f")), "first");
}

void end(int) {
  remove_temporaries();
  ::_exit(3);
}

TEST(Leftovers, ASignalHandlerCanRemoveThem) {
  const ScratchFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGTERM, end);
    AtomicFile a(folder.file("a")), b(folder.file("b"));
    a.write("half");
    write_file_atomically(folder.file("c"), "whole");
    ::kill(::getpid(), SIGTERM);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 3);
  EXPECT_THAT(folder.names(), ElementsAre("c"));
}

TEST(Leftovers, ATemporaryIsNoWiderThanTheFile) {
  const ScratchFolder folder;
  write_file_atomically(folder.file("f"), "secret");
  fs::permissions(folder.file("f"), fs::perms(0600));
  const AtomicFile writing(folder.file("f"));
  for (const std::string& name : folder.names())
    EXPECT_EQ(fs::status(folder.file(name)).permissions(), fs::perms(0600)) << name;
}

// Names of open files, such as /dev/stdout, lead to what is open: behind what is there already.
TEST(Leftovers, DescriptorsAreWrittenTo) {
  const ScratchFolder folder;
  folder.write("f", "before ");
  const int descriptor = ::open(folder.file("f").c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  ASSERT_GE(descriptor, 0);
  for (const std::string parent : {"/dev/fd/", "/proc/self/fd/"}) {
    require_writable(parent + std::to_string(descriptor));
    write_file_atomically(parent + std::to_string(descriptor), "and ");
  }
  ::close(descriptor);
  EXPECT_EQ(read_file(folder.file("f")), "before and and ");
  EXPECT_THAT(error_of([&] { require_writable("/dev/fd/" + std::to_string(descriptor)); }),
              HasSubstr("cannot write"));
  EXPECT_THAT(folder.names(), ElementsAre("f"));
}

}  // namespace
}  // namespace sunbeam
