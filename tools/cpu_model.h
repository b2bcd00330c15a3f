// SPDX-License-Identifier: BSD-3-Clause
// The name of the processor, to stand beside every measured time.
#pragma once

#include <string>

namespace lsv::cli {

/// As the kernel calls it, with the number of processors; "unknown" where it does not say.
std::string cpu_model();

}  // namespace lsv::cli
