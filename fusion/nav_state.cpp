// SPDX-License-Identifier: BSD-3-Clause
#include "fusion/nav_state.h"

namespace lsv {

std::string_view word(NavStatus status) {
  switch (status) {
    case NavStatus::not_started:
      return "not_started";
    case NavStatus::ok:
      return "ok";
    case NavStatus::optical_lost:
      return "optical_lost";
    case NavStatus::no_motion_source:
      return "no_motion_source";
  }
  return "";
}

}  // namespace lsv
