// SPDX-License-Identifier: BSD-3-Clause
// The fields of lsv's own messages, named once: encoding, decoding, the definition that travels
// with a recording, and the comparison of two steps all walk through them. The name of a field is
// its name in the definition and carries its unit.
// A structured binding of the whole struct breaks the build when a field is added and not listed.
// Internal to lsv/mcap: use messages.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "lsv/mcap/messages.h"

namespace lsv::mcap {

/// Words that stand for the values of an enumeration in a recording.
inline std::string_view word(Severity severity) {
  constexpr std::array<std::string_view, 3> kWords = {"info", "warning", "error"};
  return kWords[static_cast<std::size_t>(severity)];
}

template <typename Enum>
struct AllOf;
template <>
struct AllOf<ShiftStatus> {
  static constexpr auto kValues = kAllShiftStatuses;
};
template <>
struct AllOf<Search> {
  static constexpr std::array kValues = {Search::none, Search::predicted, Search::full_range};
};
template <>
struct AllOf<MotionState> {
  static constexpr std::array kValues = {MotionState::unknown, MotionState::at_rest,
                                         MotionState::moving};
};
template <>
struct AllOf<StreamState> {
  static constexpr std::array kValues = {StreamState::starting, StreamState::running,
                                         StreamState::lost, StreamState::degraded,
                                         StreamState::ended};
};

template <typename Enum>
std::optional<Enum> value_of(std::string_view text) {
  for (const Enum value : AllOf<Enum>::kValues) {
    if (word(value) == text) return value;
  }
  return std::nullopt;
}

/// `visit(name, value)` for each field; `Of` is the struct, const or not.
template <typename Of, typename Visit>
requires std::is_same_v<std::remove_const_t<Of>, FrameNote>
void visit_fields(Of& note, Visit&& visit) {
  auto& [index, stamp_ns, bit_depth, camera_id, has_camera_ns, camera_ns, arrival_ns, damaged,
         missing_before, dropped_before, rejected_before, stamp_replaced, latency_ns] = note;
  visit("index", index);
  visit("stamp_ns", stamp_ns);
  visit("bit_depth", bit_depth);
  visit("camera_id", camera_id);
  visit("has_camera_ns", has_camera_ns);
  visit("camera_ns", camera_ns);
  visit("arrival_ns", arrival_ns);
  visit("damaged", damaged);
  visit("missing_before", missing_before);
  visit("dropped_before", dropped_before);
  visit("rejected_before", rejected_before);
  visit("stamp_replaced", stamp_replaced);
  visit("latency_ns", latency_ns);
}

template <typename Of, typename Visit>
requires std::is_same_v<std::remove_const_t<Of>, Dropout>
void visit_fields(Of& dropout, Visit&& visit) {
  auto& [frames, first_frame, last_frame, first_ns, last_ns] = dropout;
  visit("frames", frames);
  visit("first_frame", first_frame);
  visit("last_frame", last_frame);
  visit("first_ns", first_ns);
  visit("last_ns", last_ns);
}

template <typename Of, typename Visit>
requires std::is_same_v<std::remove_const_t<Of>, StepReport>
void visit_fields(Of& step, Visit&& visit) {
  auto& [frame, stamp, dt_ns, shift, velocity, position, search, keyframe, segment, motion,
         deformation, static_share] = step;
  auto& [dx_px, dy_px, cov, model_sigma_x_px, model_sigma_y_px, quality, status] = shift;
  auto& [xx_px2, xy_px2, yy_px2] = cov;
  auto& [zncc, q, peak_ratio, peak_to_rms, zncc_sigmas, outlier_probability] = quality;
  auto& [vx_m_s, vy_m_s, sigma_vx_m_s, sigma_vy_m_s] = velocity;
  auto& [x_m, y_m, sigma_x_m, sigma_y_m] = position;
  auto& [rotation_rad, sigma_rotation_rad, expansion_ratio, sigma_expansion_ratio] = deformation;
  visit("frame", frame);
  visit("stamp_ns", stamp.ns);
  visit("dt_ns", dt_ns);
  visit("dx_px", dx_px);
  visit("dy_px", dy_px);
  visit("cov_xx_px2", xx_px2);
  visit("cov_xy_px2", xy_px2);
  visit("cov_yy_px2", yy_px2);
  visit("model_sigma_x_px", model_sigma_x_px);
  visit("model_sigma_y_px", model_sigma_y_px);
  visit("zncc", zncc);
  visit("q", q);
  visit("peak_ratio", peak_ratio);
  visit("peak_to_rms", peak_to_rms);
  visit("zncc_sigmas", zncc_sigmas);
  visit("outlier_probability", outlier_probability);
  visit("status", status);
  visit("vx_m_s", vx_m_s);
  visit("vy_m_s", vy_m_s);
  visit("sigma_vx_m_s", sigma_vx_m_s);
  visit("sigma_vy_m_s", sigma_vy_m_s);
  visit("x_m", x_m);
  visit("y_m", y_m);
  visit("sigma_x_m", sigma_x_m);
  visit("sigma_y_m", sigma_y_m);
  visit("search", search);
  visit("keyframe", keyframe);
  visit("segment", segment);
  visit("motion", motion);
  visit("rotation_rad", rotation_rad);
  visit("sigma_rotation_rad", sigma_rotation_rad);
  visit("expansion_ratio", expansion_ratio);
  visit("sigma_expansion_ratio", sigma_expansion_ratio);
  visit("static_share", static_share);
}

template <typename Of, typename Visit>
requires std::is_same_v<std::remove_const_t<Of>, HealthSnapshot>
void visit_fields(Of& health, Visit&& visit) {
  auto& [state, received, processed, dropped, queued, rejected, missing, gaps, bad_stamps,
         shifts_ok, shifts_refused, since_valid_shift_s, deadline_misses, reports_dropped,
         log_dropped, restarts, transport_losses, frame_rate_hz, latency, queue_age_max_s,
         since_result_s, worker_stalls] = health;
  auto& [count, p50_s, p99_s, p999_s, max_s] = latency;
  static_assert(kAllFrameRejections == std::array{FrameRejection::damaged,
                                                  FrameRejection::wrong_format,
                                                  FrameRejection::duplicate, FrameRejection::late,
                                                  FrameRejection::refused});
  visit("state", state);
  visit("received", received);
  visit("processed", processed);
  visit("dropped", dropped);
  visit("queued", queued);
  visit("rejected_damaged", rejected[0]);
  visit("rejected_wrong_format", rejected[1]);
  visit("rejected_duplicate", rejected[2]);
  visit("rejected_late", rejected[3]);
  visit("rejected_refused", rejected[4]);
  visit("missing", missing);
  visit("gaps", gaps);
  visit("bad_stamps", bad_stamps);
  visit("shifts_ok", shifts_ok);
  visit("shifts_refused", shifts_refused);
  visit("since_valid_shift_s", since_valid_shift_s);
  visit("deadline_misses", deadline_misses);
  visit("reports_dropped", reports_dropped);
  visit("log_dropped", log_dropped);
  visit("restarts", restarts);
  visit("transport_losses", transport_losses);
  visit("frame_rate_hz", frame_rate_hz);
  visit("latency_count", count);
  visit("latency_p50_s", p50_s);
  visit("latency_p99_s", p99_s);
  visit("latency_p999_s", p999_s);
  visit("latency_max_s", max_s);
  visit("queue_age_max_s", queue_age_max_s);
  visit("since_result_s", since_result_s);
  visit("worker_stalls", worker_stalls);
}

}  // namespace lsv::mcap
