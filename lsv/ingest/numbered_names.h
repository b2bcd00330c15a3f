// SPDX-License-Identifier: BSD-3-Clause
// Frame numbers in file names: natural order (img2 before img10), and the question whether a list
// of files is one numbered family, i.e. same folder and same text with ONE number that varies.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lsv {

/// Digit runs compare as numbers, everything else byte by byte.
bool natural_less(const std::string& a, const std::string& b);

/// The number of each path, in the order of `paths`; nothing when they are not one family, when
/// there are fewer than two, or when a number has more than 18 digits.
std::optional<std::vector<std::int64_t>> numbers_of_family(const std::vector<std::string>& paths);

}  // namespace lsv
