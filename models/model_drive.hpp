// What the drive of a scene moves and loads.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "coupling/contact_parameters.hpp"
#include "models/model_body.hpp"

namespace stridor {

/// Bodies without degrees of freedom that carry the masters without end.
struct EndlessMasters {
  int at_rest = -1;  ///< index of the body; −1 where no contact has such a master
  int moving = -1;   ///< with the drive
};

/// Whether the drive moves the master of a pair.
bool moves_master(const DriveParameters& drive, const std::string& pair);

/// Refuses what the drive is to move and is not there, or cannot be moved by it.
void check_drive(const DriveParameters& drive,
                 const std::map<std::string, ContactParameters>& pairs);

/// Adds the bodies of masters without end, which come last.
EndlessMasters add_endless_masters(const DriveParameters& drive,
                                   const std::map<std::string, ContactParameters>& pairs,
                                   std::vector<ModelBody>& bodies);

/// A master without end: its one row stays where the body is.
SystemBody make_rigid_body(const std::string& name);

/// Whether the supports of a body follow the drive.
bool follows_drive(const ModelBody& body, const DriveParameters& drive);

/// Refuses a velocity that nothing follows: contacts would be taken to slide and do not.
void check_something_follows(const DriveParameters& parameters, const Drive& drive,
                             const std::vector<ModelBody>& bodies, const EndlessMasters& endless);

/// Size of the drive's load in the end, N.
double final_load(const DriveParameters& drive);

/// Refuses loads on what is not there.
void check_loads(const DriveParameters& drive, const std::vector<ModelBody>& bodies);

/// Row of a body on which the drive's load acts; −1 where there is none. What it acts on is kept by
/// the reduction.
int load_row_of(ModelBody& body, const DriveParameters& drive);

}  // namespace stridor
