// SPDX-License-Identifier: BSD-3-Clause
// Metadata that a reader can trust: MCAP gives them no CRC, so they carry their own.
#pragma once

#include "lsv/mcap/records.h"

namespace lsv::mcap {

/// With an entry "crc32" over the name and all other entries.
Metadata sealed(Metadata metadata);
/// Whether it is one of these and as it was written.
bool is_sealed(const Metadata& metadata);

}  // namespace lsv::mcap
