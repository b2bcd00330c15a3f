// SPDX-License-Identifier: BSD-3-Clause
// Numbers as the accuracy report writes them.
#pragma once

#include <string>

namespace lsv::bench {

/// Three significant digits without an exponent; "-" for NaN.
std::string three_digits(double value);

}  // namespace lsv::bench
