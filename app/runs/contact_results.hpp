// Files and pictures of the verb contact.
#pragma once

#include <vector>

#include "app/runs/contact_options.hpp"
#include "app/runs/contact_study.hpp"

namespace stridor {

/// Writes the rows, and of boundary elements the fields, to options.output.
/// @throws FileError
void write_rows(const ContactOptions& options, const LoadedScene& loaded,
                const std::vector<LawRow>& rows);

/// Draws the pressure of a row into options.pressure_figure.
void draw_pressure(const ContactOptions& options, const LoadedScene& loaded,
                   const StudiedContact& contact, const LawRow& row);

/// Draws the edges of the contacts into options.edges_figure.
void draw_edges(const ContactOptions& options, const LoadedScene& loaded,
                const StudiedContact& contact, const std::vector<LawRow>& rows);

}  // namespace stridor
