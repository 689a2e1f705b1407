// What the drives of a scene move, load and displace.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "coupling/system/contact_parameters.hpp"
#include "models/contact_pair.hpp"
#include "models/model_body.hpp"

namespace stridor {

/// Bodies without degrees of freedom that carry the masters without end: by the index of the drive that
/// moves them, −1 for those at rest.
using EndlessMasters = std::map<int, int>;

/// Refuses names of what no drive can move.
void check_drives(const std::vector<SceneDrive>& drives,
                  const std::map<std::string, ContactParameters>& pairs,
                  const std::vector<ModelBody>& bodies);

/// Adds the bodies of masters without end, which come last.
EndlessMasters add_endless_masters(const std::vector<SceneDrive>& drives,
                                   const std::map<std::string, ContactParameters>& pairs,
                                   std::vector<ModelBody>& bodies);

/// Index of the drive that moves the master without end of a pair; −1 where none does.
int mover_of_master(const std::vector<SceneDrive>& drives, const std::string& pair);

/// Sets ModelBody::drive of all bodies with guided supports.
/// @throws ConfigError where two drives move one body
void assign_drives(const std::vector<SceneDrive>& drives, std::vector<ModelBody>& bodies);

/// A master without end: its one row stays where the body is.
SystemBody make_rigid_body(const ModelBody& body);

/// Refuses velocities that nothing follows: contacts would be taken to slide and do not.
/// @param driven of the same drives
void check_something_follows(const std::vector<SceneDrive>& drives,
                             const std::vector<Drive>& driven,
                             const std::vector<ModelBody>& bodies);

/// The ramp of the drive that moves one of the bodies of a pair, of the slave first, else of one that
/// loads one of them; the loads on the slave, else on the master. With one drive those of that drive.
PairDrive drive_of_pair(const std::vector<SceneDrive>& drives, const std::vector<ModelBody>& bodies,
                        int slave, int master);

/// Refuses loads on what is not there.
void check_loads(const std::vector<SceneDrive>& drives, const std::vector<ModelBody>& bodies);

/// Loads of the drives on a body. What they act on is kept by the reduction, but for surfaces and
/// springs, whose loads act on what is recovered.
std::vector<BodyLoad> loads_of(ModelBody& body, const std::vector<SceneDrive>& drives);

}  // namespace stridor
