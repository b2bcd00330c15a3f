// SPDX-License-Identifier: BSD-3-Clause
// What `lsv calibrate mount` says as a page that needs no network.
#pragma once

#include <string>

#include "tools/mount_report.h"

namespace lsv::cli {

std::string mount_html(const MountReport& report);

}  // namespace lsv::cli
