// The slide of a run: where its bodies, contacts and recorded points are over time.
#pragma once

#include <string>

#include "app/report/report_section.hpp"
#include "app/results/pictures.hpp"

namespace stridor {

/// Adds a view with the bodies at rest and what moves them over the time of the run: the
/// displacement of every drive, by its law in the scene, which is what the run followed; the speed
/// of bodies that spin; the slave points with the normals there, and the recorded points with the
/// directions of their channels, whose samples the page takes from the histories. What cannot be
/// drawn becomes a remark of the section: files that the scene names may be gone. Nothing is added
/// for a scene without bodies.
///
/// @param resolved scene as the file holds it
/// @param source   of it, for messages
/// @param bytes    that the view may take of the page
void add_slide(const std::string& resolved, const std::string& source, const RecordedStretch& run,
               double bytes, ReportPage& page, Json& section);

}  // namespace stridor
