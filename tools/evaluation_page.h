// SPDX-License-Identifier: BSD-3-Clause
// The page of `lsv evaluate`: both trajectories, errors along the way, RPE over the length.
#pragma once

#include <string>

#include "tools/evaluation_report.h"

namespace lsv::cli {

std::string evaluation_html(const EvaluationReport& report);

}  // namespace lsv::cli
