#include "bake/cli/console.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <string>

#include "sunbeam/core/error.h"
#include "sunbeam/detail/text.h"

namespace sunbeam {
namespace {

int output_error = 0;  // errno of the first failure

void note_output(bool is_written) {
  if (!is_written && output_error == 0) output_error = errno != 0 ? errno : EIO;
}

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
  errno = 0;
  note_output(std::fwrite(text.data(), 1, text.size(), stdout) == text.size());
}

void write_message(std::string_view text) { std::fwrite(text.data(), 1, text.size(), stderr); }

void message_line(std::string_view line) { write_message(printable(line) + "\n"); }

void require_output_written() {
  errno = 0;
  note_output(std::fflush(stdout) == 0);
  note_output(!std::cout.bad() && std::cout.flush());
  const int copy = ::dup(STDOUT_FILENO);  // network file systems report some errors when a file is closed
  note_output(copy < 0 || ::close(copy) == 0);
  if (output_error != 0)
    throw Error(std::string("standard output: cannot write: ") + std::strerror(output_error));
}

}  // namespace sunbeam
