#include "bake/cli/console.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <string>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

bool output_is_lost = false;

}  // namespace

void prepare_console() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) != -1 || errno != EBADF) continue;
    // The wrong way round, so that reading and writing fail. It takes the lowest number that is free.
    [[maybe_unused]] const int same = ::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
  std::signal(SIGPIPE, SIG_IGN);
}

void write_output(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) output_is_lost = true;
}

void write_message(std::string_view text) { std::fwrite(text.data(), 1, text.size(), stderr); }

void message_line(std::string_view line) { write_message(printable(line) + "\n"); }

void require_output_written() {
  const int copy = ::dup(STDOUT_FILENO);  // network file systems report some errors when a file is closed
  const bool is_written = std::fflush(stdout) == 0 && std::cout.flush() && (copy < 0 || ::close(copy) == 0);
  if (output_is_lost || !is_written) fail_output();
}

void fail_output() { throw Error("standard output: cannot write"); }

}  // namespace sunbeam
