// SPDX-License-Identifier: BSD-3-Clause
// Numbers as the accuracy report writes them.
#pragma once

#include <string>

namespace lsv::bench {

/// printf into a string.
std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));

/// Three significant digits without an exponent; "-" for NaN.
std::string three_digits(double value);

}  // namespace lsv::bench
