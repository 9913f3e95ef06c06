// This class makes Ctrl-C and SIGTERM a question to ask: while an object is alive, the signals are remembered
// and do not end the program.
#pragma once

#include <csignal>

namespace sunbeam {

class Interrupt {
 public:
  Interrupt() {
    requested_ = 0;
    old_interrupt_ = std::signal(SIGINT, remember);
    old_terminate_ = std::signal(SIGTERM, remember);
  }
  ~Interrupt() {
    std::signal(SIGINT, old_interrupt_);
    std::signal(SIGTERM, old_terminate_);
  }
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  bool requested() const { return requested_ != 0; }

 private:
  static void remember(int) { requested_ = 1; }

  static inline volatile std::sig_atomic_t requested_ = 0;
  void (*old_interrupt_)(int);
  void (*old_terminate_)(int);
};

}  // namespace sunbeam
