// SPDX-License-Identifier: BSD-3-Clause
// Numbers as text: decimal point whatever the locale, the same bytes on every machine.
// Each function appends to `out`; an unknown (NaN or infinite) number appends nothing.
#pragma once

#include <cstdint>
#include <string>

namespace lsv {

/// `decimals` digits after the point, 0..17. Never writes "-0.000".
void append_fixed(std::string& out, double value, int decimals);

/// The shortest text that reads back as the same number.
void append_shortest(std::string& out, double value);

void append_integer(std::string& out, std::int64_t value);

/// Nanoseconds as seconds with nine decimals, exact over the whole int64 range.
void append_seconds(std::string& out, std::int64_t time_ns);

/// printf into a string; the decimal point is that of the locale, which lsv never sets.
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace lsv
