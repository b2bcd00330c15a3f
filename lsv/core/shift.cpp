// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/core/shift.h"

namespace lsv {

std::string_view word(ShiftStatus status) {
  switch (status) {
    case ShiftStatus::ok:
      return "ok";
    case ShiftStatus::first_frame:
      return "first_frame";
    case ShiftStatus::dark:
      return "dark";
    case ShiftStatus::saturated:
      return "saturated";
    case ShiftStatus::low_contrast:
      return "low_contrast";
    case ShiftStatus::frozen:
      return "frozen";
    case ShiftStatus::peak_at_border:
      return "peak_at_border";
    case ShiftStatus::flat_peak:
      return "flat_peak";
    case ShiftStatus::ambiguous:
      return "ambiguous";
    case ShiftStatus::static_pattern:
      return "static_pattern";
    case ShiftStatus::inconsistent:
      return "inconsistent";
    case ShiftStatus::below_zncc_gate:
      return "below_zncc_gate";
    case ShiftStatus::below_q_gate:
      return "below_q_gate";
  }
  return "unknown";
}

std::string_view advice(ShiftStatus status) {
  switch (status) {
    case ShiftStatus::ok:
      return "The shift passed every gate.";
    case ShiftStatus::first_frame:
      return "There is no earlier frame to compare with.";
    case ShiftStatus::dark:
      return "The frame is dark: check the laser, the lens cover, the exposure and, for 16-bit "
             "frames, --bit-depth.";
    case ShiftStatus::saturated:
      return "Too many pixels are at full scale: reduce exposure or laser power.";
    case ShiftStatus::low_contrast:
      return "There is no pattern above the camera noise: check focus, laser and surface.";
    case ShiftStatus::frozen:
      return "The frame repeats the one before bit for bit: the camera or its driver is stuck.";
    case ShiftStatus::peak_at_border:
      return "The motion reaches the edge of the search range: raise --max-shift or the frame "
             "rate.";
    case ShiftStatus::flat_peak:
      return "The correlation peak has no usable shape: speckle may be under 2 px wide.";
    case ShiftStatus::ambiguous:
      return "Two correlation peaks are nearly equal: the pattern repeats or has been lost.";
    case ShiftStatus::static_pattern:
      return "Something that stays on the sensor outweighs the ground, which moves: clean the "
             "optics, "
             "or cut borders off with --roi.";
    case ShiftStatus::inconsistent:
      return "Some rows of the frame do not show the motion of the others: the frame is torn or "
             "incomplete; check the transport and the buffers of the camera.";
    case ShiftStatus::below_zncc_gate:
      return "The frames resemble each other too little: the motion may exceed --max-shift, or "
             "the speckle boils.";
    case ShiftStatus::below_q_gate:
      return "The correlation peak does not stand out from the plane: see --min-q.";
  }
  return "";
}

}  // namespace lsv
