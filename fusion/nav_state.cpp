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

std::string_view word(HeadingSource source) {
  switch (source) {
    case HeadingSource::nothing:
      return "nothing";
    case HeadingSource::side_slip:
      return "side_slip";
    case HeadingSource::wheels:
      return "wheels";
    case HeadingSource::gyro:
      return "gyro";
    case HeadingSource::optics:
      return "optics";
  }
  return "";
}

}  // namespace lsv
