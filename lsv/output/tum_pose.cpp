// SPDX-License-Identifier: BSD-3-Clause
#include "lsv/output/tum_pose.h"

#include <cmath>

#include "lsv/output/number_text.h"

namespace lsv {
namespace {

constexpr int kMetricDecimals = 9;
constexpr int kQuaternionDecimals = 12;

}  // namespace

void append_tum_pose(std::string& out, Stamp stamp, double x_m, double y_m, double yaw_rad) {
  append_seconds(out, stamp.ns);
  out += ' ';
  append_fixed(out, x_m, kMetricDecimals);
  out += ' ';
  append_fixed(out, y_m, kMetricDecimals);
  if (yaw_rad == 0.0) {
    out += " 0 0 0 0 1\n";
    return;
  }
  out += " 0 0 0 ";
  append_fixed(out, std::sin(yaw_rad / 2.0), kQuaternionDecimals);
  out += ' ';
  append_fixed(out, std::cos(yaw_rad / 2.0), kQuaternionDecimals);
  out += '\n';
}

}  // namespace lsv
