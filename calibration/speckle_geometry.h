// SPDX-License-Identifier: BSD-3-Clause
// What the optics alone say about the scale: how far the speckle pattern moves on the sensor for a
// unit of surface travel (Sc), how Sc changes when a distance does, what a tilt looks like, how
// large the speckles are.
//
// Objective speckle (no lens), surface travel a, tilt about an axis through the lit spot:
//   A = a (1 + L_o / R_s) + 2 L_o tilt
// R_s: wavefront radius at the surface, the distance of the virtual source (behind the collimator,
// not the exit of the laser); L_o: surface to sensor. I. Yamaguchi, "Speckle displacement and
// decorrelation in the diffraction and image fields for small object deformation", Opt. Acta 28
// (1981) 1359, for normal incidence and observation.
//
// Imaged speckle (a camera focused on the surface): A = -M a. Out of focus by dz the camera sees
// the objective pattern at the distance dz from the surface: A = -M (a (1 + dz / R_s) + 2 dz tilt).
//
// Assumed: paraxial, rigid and flat surface, travel small against the lit spot. Magnitudes only.
//
// Pure functions, any thread. Arguments must be finite and above 0 unless stated; kUnknown in,
// kUnknown out.
#pragma once

#include <optional>

#include "lsv/core/shift.h"

namespace lsv {

/// The distances that make the scale of objective speckle.
struct ObjectiveGeometry {
  double source_distance_m = kUnknown;  // R_s; +infinity: collimated
  double sensor_distance_m = kUnknown;  // L_o
};

/// Sc = 1 + L_o / R_s: above 1; 2 for source and sensor at one height, 1 for collimated light.
double predicted_sc(const ObjectiveGeometry& geometry);

/// Change of Sc per metre by which a distance grows.
struct ScSlopes {
  double source_per_m = kUnknown;  // -L_o / R_s^2
  double sensor_per_m = kUnknown;  // 1 / R_s
  double height_per_m = kUnknown;  // both together: (R_s - L_o) / R_s^2; 0 at equal heights
};

/// All zero for collimated light.
ScSlopes sc_slopes(const ObjectiveGeometry& geometry);

/// Pattern travel on the sensor per tilt of the surface against the sensor, 2 L_o: m per rad, or
/// m/s per rad/s.
double tilt_shift_m_per_rad(const ObjectiveGeometry& geometry);

/// The surface travel that this tilt is mistaken for, 2 L_o / Sc.
double tilt_travel_m_per_rad(const ObjectiveGeometry& geometry);

/// lambda z / D. The FWHM of the autocovariance is 1.03 of it for an evenly lit disc, 1.06 for a
/// Gaussian beam with D at 1/e^2. The spectrum of the pattern ends at 1 / size.
double objective_speckle_m(double wavelength_m, double sensor_distance_m, double spot_diameter_m);

/// lambda (1 + M) F#, on the sensor; FWHM as above. M: image size / object size.
double imaged_speckle_m(double wavelength_m, double magnification, double f_number);

/// Surface to the front principal plane of a focused simple lens, f (1 + 1 / M).
double object_distance_m(double focal_length_m, double magnification);

/// Relative change of M per metre of height when the lens is focused again, -1 / (z - f) = -M / f.
double refocused_slope_per_m(double focal_length_m, double magnification);

/// Relative change of Sc per metre of height, lens and sensor left as they are, at focus: 1 / R_s.
/// It is not the change of the image size: the pattern out of focus is an objective one.
double fixed_focus_slope_per_m(double source_distance_m);

/// The surface travel that a tilt is mistaken for when the surface lies `defocus_m` beyond the
/// plane of focus, 2 dz: 0 at focus, any sign.
double imaged_tilt_travel_m_per_rad(double defocus_m);

/// Speckles below it alias: the spectrum of the pattern passes half a cycle per px.
inline constexpr double kAliasedSpeckle_px = 2.0;
/// From here on sub-pixel interpolation has nothing to fear.
inline constexpr double kGoodSpeckle_px = 3.0;

/// The part of the frame side that a shift between two frames should not exceed.
inline constexpr double kLargestShiftFraction = 0.25;

/// What turns px on the sensor into motion of the surface.
struct SensorScale {
  double sc_ratio = kUnknown;  // Sc, or the magnification
  double pixel_pitch_m = kUnknown;
  double rate_hz = kUnknown;
};

/// Surface travel per px of shift.
double surface_m_per_px(const SensorScale& scale);

/// Surface travel that carries the pattern over `window_px`; for imaged speckle the field of view.
double window_on_ground_m(const SensorScale& scale, double window_px);

/// `speed_m_s` may have any sign or be 0.
double shift_px_per_frame(const SensorScale& scale, double speed_m_s);

/// The speed that shifts the pattern by kLargestShiftFraction of `window_px` per frame.
double largest_speed_m_s(const SensorScale& scale, double window_px);

/// One standard deviation of the velocity of one frame: pitch sigma_px / (Sc dt).
double velocity_sigma_m_s(const SensorScale& scale, double sigma_px);

/// Where a distance would have to be, and how far that is from where it was taken to be.
struct DistanceChange {
  double distance_m = kUnknown;  // +infinity: a collimated source
  double change_m = kUnknown;    // distance_m - assumed; infinite when only one of them is
  double sigma_m = kUnknown;     // from the sigma of the measured Sc, first order
};

/// An angle that was taken to be 0.
struct AngleChange {
  double angle_rad = kUnknown;
  double sigma_rad = kUnknown;  // as above
};

/// Each entry is one geometry error that alone would turn the predicted Sc into the measured one;
/// empty where no distance above 0, and no angle, does.
struct ScExplanation {
  double difference_ratio = kUnknown;    // measured - predicted
  std::optional<DistanceChange> source;  // R_s alone
  std::optional<DistanceChange> sensor;  // L_o alone
  std::optional<DistanceChange> height;  // both by the same change; distance_m is the sensor's
  /// Angle of the beam to the normal, in the plane of the measured axis: there
  /// Sc = 1 + cos^2(angle) L_o / R_s, while across it Sc stays. Only ever lowers Sc.
  std::optional<AngleChange> incidence;
};

/// `measured_sc_sigma` may be kUnknown: then so is every sigma.
ScExplanation explain_sc(const ObjectiveGeometry& assumed, double measured_sc,
                         double measured_sc_sigma);

/// How far beyond the plane of focus (positive: farther from the lens) the surface would have to be
/// for imaged speckle to move by `measured_sc` instead of `magnification`, R_s (Sc / M - 1), with
/// the source where it is. kUnknown for collimated light, which no defocus changes.
double defocus_for_sc_m(double source_distance_m, double magnification, double measured_sc);

}  // namespace lsv
