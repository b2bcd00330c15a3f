// SPDX-License-Identifier: BSD-3-Clause
#include "tools/interrupt.h"

#include <csignal>

namespace lsv::cli {
namespace {

volatile std::sig_atomic_t g_interrupted = 0;

extern "C" void set_interrupted(int) { g_interrupted = 1; }

}  // namespace

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = set_interrupted;
  // The first signal restores the default, so that a second one can end a process that hangs;
  // without SA_RESTART a read that waits for a pipe returns.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return g_interrupted != 0; }

}  // namespace lsv::cli
