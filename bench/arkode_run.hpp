// An independent run of a scene with one sliding contact: SUNDIALS ARKODE, event by event.
#pragma once

#include <cstdio>  // which the next one takes for granted

#include <arkode/arkode_butcher_erk.h>

#include <cstdint>

#include "analysis/precision_study.hpp"
#include "coupling/system/system.hpp"

namespace stridor::bench {

struct ArkodeParameters {
  ARKODE_ERKTableID table = ARKODE_VERNER_8_5_6;
  double relative_tolerance = 1e-9;
  double displacement_tolerance = 1e-15;  ///< of modal displacements, kg^½ m
  double velocity_tolerance = 1e-10;      ///< of modal velocities, kg^½ m/s
  double drift_rate = 2.0e6;              ///< η of Baumgarte's terms, 1/s
  double fixed_step = 0.0;                ///< s; 0 for error control by the tolerances
};

struct ArkodeResult {
  SampledRun samples;
  std::int64_t steps = 0;
  std::int64_t evaluations = 0;
  std::int64_t kinks = 0;
  double seconds = 0.0;    ///< of processor time, s
  double setup = 0.0;      ///< of it before the first step, s
  double stepping = 0.0;   ///< of all steps at the pace of the fastest stretch, s
  double worst_gap = 0.0;  ///< largest |gap| at a sample, m
};

/// Subs-b on a polyline, bilateral, as an ordinary differential equation between kinks.
///
/// With s = T2 − T1 and a = C − T1 the gap is closed where G = s × a = 0. Two time derivatives of
/// it,
///
///   s̈ × a + 2 ṡ × ȧ + s × ä + 2 η Ġ + η² G = 0,
///
/// are linear in λ, which they give (Baumgarte's terms keep the drift below rounding). An explicit
/// Runge-Kutta method marches q and q̇ from the initial motion of the bodies. At ξ = 1 and ξ = 0,
/// found as roots, the slope jumps: an impulse Λ along the force direction of the new segment makes
/// Ġ = 0 there.
///
/// It shares with the program the modal form of the bodies and the curves of the drive.
/// @throws std::runtime_error where ARKODE fails or the system is of another kind
ArkodeResult run_arkode(const System& system, ObservedRow observed, double interval,
                        std::int64_t num_samples, const ArkodeParameters& parameters = {});

}  // namespace stridor::bench
