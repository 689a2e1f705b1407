// Laws for bodies in motion, made by boundary elements: the verb contact with --master-curve and
// --table.
#pragma once

#include "app/runs/contact_options.hpp"
#include "app/runs/contact_study.hpp"

namespace stridor {

/// Computes the master curve of a contact's material and writes it to options.master_curve: as HDF5
/// (.h5) or as rows of C++, with which the program is compiled.
/// @throws ConfigError if contacts of its indenter and material do not lie on one curve, or for a
///         name with another ending
/// @throws NumericalError if a point does not converge
ExitCode make_master_curve(const ContactOptions& options, const LoadedScene& loaded,
                           const StudiedContact& contact);

/// Computes a table of contacts and writes it to options.table, which `normal.form` takes.
/// @throws ConfigError if the indenter ends
/// @throws NumericalError if a contact does not converge, or has no friction
ExitCode make_table(const ContactOptions& options, const LoadedScene& loaded,
                    const StudiedContact& contact);

}  // namespace stridor
