// SPDX-License-Identifier: BSD-3-Clause
// SHA-256 of a text as 64 lower-case hex digits: names the calibration that a result came from.
#pragma once

#include <string>
#include <string_view>

namespace lsv {

std::string sha256_hex(std::string_view bytes);

}  // namespace lsv
