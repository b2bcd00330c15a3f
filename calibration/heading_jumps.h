// SPDX-License-Identifier: BSD-3-Clause
// Single headings of a reference that jump out of those around them (markers mistaken for each
// other): further from the median of five than 8 sigma, than 8 times what is usual in this
// reference (Hampel's identifier), and than 3 times what the body turns between two poses when it
// turns fast. Pure functions; they allocate.
#pragma once

#include <vector>

#include "calibration/drive.h"

namespace lsv {

/// True where the heading jumps.
std::vector<bool> heading_jumps(const BodyReference& reference);

}  // namespace lsv
