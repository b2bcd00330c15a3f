// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/core/step_report.h"

namespace lsv {

std::string_view word(Search search) {
  switch (search) {
    case Search::none:
      return "none";
    case Search::predicted:
      return "predicted";
    case Search::full_range:
      return "full_range";
  }
  return "unknown";
}

std::string_view word(MotionState motion) {
  switch (motion) {
    case MotionState::unknown:
      return "unknown";
    case MotionState::at_rest:
      return "at_rest";
    case MotionState::moving:
      return "moving";
  }
  return "unknown";
}

}  // namespace lsv
