// SPDX-License-Identifier: BSD-3-Clause
// Ctrl-C and SIGTERM as a flag that loops look at, so that files are closed well.
#pragma once

namespace lsv::cli {

/// From now on SIGINT and SIGTERM only set the flag; a second one ends the process at once.
void catch_interrupts();
bool interrupted();

}  // namespace lsv::cli
