// The step of several simultaneous simulations, one in each lane of a vector.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "coupling/kinematics/contact.hpp"
#include "solvers/integrators/modal_kernel.hpp"

namespace stridor {

/// Simulations that a vector of this processor holds: 8 with AVX-512, 4 with AVX2, else 2.
std::size_t num_kernel_lanes();

/// Numbers of one body in all lanes. Every pointer is to entries of num_kernel_lanes() numbers,
/// 64-byte aligned, one for each lane; names are those of ModalRecurrence and Propagator.
struct BodyLanes {
  std::size_t num_modes = 0;
  std::size_t num_ports = 0;  ///< 2 of a slave, 4 of a straight segment of a master
  bool has_residual = false;

  std::array<double*, num_modal_fields> fields{};  ///< by ModalField, an entry per mode
  double* rows = nullptr;                          ///< an entry per port, mode after mode
  double* compliance = nullptr;                    ///< W, column after column
  double* lag = nullptr;                           ///< (1 − w) R, likewise
  double* share = nullptr;                         ///< w
  // Entries per port.
  double* load = nullptr;
  double* predicted = nullptr;
  double* expected = nullptr;
  double* current = nullptr;
  double* increment = nullptr;
  double* answer = nullptr;
  double* lagging = nullptr;
  double* forces = nullptr;

  // A row of the body that is watched: its displacement is Σ watched_row·position, and with direct
  // feedthrough the contributions of forces, lagging forces and loads. All 0 in lanes that watch
  // none.
  bool is_watched = false;            ///< in any lane
  double* watched_row = nullptr;      ///< an entry per mode
  double* watched_forces = nullptr;   ///< an entry per port: of the forces
  double* watched_lagging = nullptr;  ///< likewise, of the lagging ones
  double* watched_load = nullptr;
};

/// One contact in all lanes: a slave point on a straight segment of another body, sliding for good.
/// Pointers as in BodyLanes; x and y are two entries.
struct ContactLanes {
  double* origin = nullptr;   ///< of the slave, undeformed, from T1
  double* end = nullptr;      ///< T2 from T1, undeformed
  double* tangent = nullptr;  ///< of the undeformed segment
  double* length = nullptr;   ///< of the undeformed segment
  double* friction = nullptr;  ///< μ

  double* xi = nullptr;
  double* found_tangent = nullptr;  ///< of the projection
  double* force = nullptr;          ///< λ_n
  double* friction_force = nullptr;
  double* slip_velocity = nullptr;
  double* force_min = nullptr;
  double* force_max = nullptr;
  double* friction_min = nullptr;  ///< of friction_force
  double* friction_max = nullptr;

  // DrivenMotion: displacement = driven_displacement + driven_rate (t − driven_from).
  double* driven_displacement = nullptr;
  double* driven_rate = nullptr;
  double* driven_from = nullptr;
  double* sliding_velocity = nullptr;  ///< with which it would slide where it is frozen
};

/// Everything that a step of all lanes reads and writes.
struct Lanes {
  bool has_feedthrough = false;
  ContactAssumption assumption = ContactAssumption::subs_b;
  BodyLanes slave;
  BodyLanes master;
  ContactLanes contact;
  double* step = nullptr;     ///< h
  double* index = nullptr;    ///< n
  double* is_used = nullptr;  ///< 1 or 0; an unused lane holds no state
  double* trace = nullptr;    ///< an entry per step: the sum of the rows watched
};

/// Steps all lanes until `max_steps` are done or a lane needs a treatment not provided here:
/// another segment, a force that pulls, jams or is not finite, sliding against the drive. Such a
/// lane has done the last step up to the contact, which is unchanged: index and bodies are at t_n,
/// ports predicted.
///
/// The results of a lane depend on no other lane, nor on which lane it is.
/// Where a row is watched, `trace` gets its displacement after every step; what it holds for a lane
/// after its flagged step means nothing.
/// @param max_steps at most the entries of `trace`, where a row is watched
/// @param flagged   1 for such lanes, else 0
/// @return steps done, the last one included
std::int64_t step_lanes(const Lanes& lanes, std::int64_t max_steps, double* flagged);

}  // namespace stridor
