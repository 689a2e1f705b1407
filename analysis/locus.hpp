// Eigenvalues along a parameter: branches, crossings of the imaginary axis, unstable windows.
#pragma once

#include <complex>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "solvers/eigenvalues/pencil.hpp"
#include "solvers/eigenvalues/secular_eigenvalues.hpp"

namespace stridor {

/// A system that depends on one parameter.
struct PencilFamily {
  /// Sets a pencil to that of a value. It is given the pencil of another value, or an empty one the
  /// first time, so that unchanged parts need not be made again. Called in any order.
  std::function<void(double value, Pencil& pencil)> place;
  /// Values where the pencil is continuous but not smooth, ascending: a contact at a master node.
  std::vector<double> kinks;
};

/// Displacements of the drive, m, ascending, at which a contact passes a node of its undeformed
/// master.
std::vector<double> kinks_along_drive(const System& system);

/// The contacts of a system sliding on the undeformed master (place_undeformed()).
///
/// @param system    referenced as long as the family is used
/// @param friction  μ of every contact, >= 0
/// @param direction χ, ±1
/// @param origin    value that belongs to no displacement of the drive, m; a value is `origin` plus
///                  the displacement. With the starting position of a contact whose master lies
///                  along x, values are its positions.
PencilFamily undeformed_family(const System& system, double friction, double direction,
                               double origin);

enum class LocusMethod {
  secular,  ///< zeros of the secular function, followed by Newton's method and counted
  dense,    ///< all eigenvalues of the dense problem at every value; the reference
};

struct LocusOptions {
  LocusMethod method = LocusMethod::secular;
  /// The eigenvalues that are wanted at every value: at most `count`, >= 1, with positive imaginary
  /// part, lowest first, and none above `frequency`, Hz, > 0.
  SpectrumWindow window = SpectrumWindow::lowest(20);
  /// Windows and crossings are of eigenvalues up to here, Hz; those above are only listed. For
  /// sampled loci (analysis/sampled_locus.hpp).
  double trusted = std::numeric_limits<double>::infinity();
  /// Smallest interval between two values, relative to the range, > 0. A window narrower than this
  /// can be missed.
  double resolution = 1e-9;
};

/// @throws std::invalid_argument if the window of a locus holds nothing
void check_window(const LocusOptions& options);

/// One eigenvalue as the parameter varies.
struct Branch {
  std::vector<double> values;           ///< ascending: those asked for, and those inserted
  std::vector<std::complex<double>> s;  ///< Im s >= 0
};

/// A value at which an eigenvalue lies on the imaginary axis.
struct Crossing {
  double value = 0.0;
  double frequency = 0.0;  ///< Hz
  int direction = 0;       ///< +1: unstable beyond the value, −1: stable beyond
  int branch = 0;          ///< index into Locus::branches; −1: none is there
};

/// An interval of values in which one eigenvalue has a positive real part.
struct UnstableWindow {
  double from = 0.0;             ///< a crossing, or where the range or the branch begins
  double to = 0.0;               ///< likewise
  double frequency = 0.0;        ///< where the growth is largest, Hz
  double growth_max = 0.0;       ///< largest real part, 1/s
  double growth_integral = 0.0;  ///< ∫ Re s over the window, 1/s times the unit of the parameter
  double value_max = 0.0;        ///< where the growth is largest
  int branch = 0;                ///< index into Locus::branches; −1: none is there
};

struct Locus {
  std::vector<double> values;  ///< as asked for
  /// At each of them: Im s >= 0, ascending; the real ones and the lowest `count`.
  std::vector<std::vector<std::complex<double>>> eigenvalues;
  /// Every eigenvalue that was followed: some more than asked for, since others may come down.
  std::vector<Branch> branches;
  std::vector<UnstableWindow> unstable;  ///< of the eigenvalues asked for, ascending `from`
  std::vector<Crossing> crossings;       ///< their ends within the range, ascending
  /// Values at which it could not be verified that the eigenvalues are all there are.
  std::vector<double> unverified;
  /// Largest distance of two values between which a window may have been missed: where spectra are
  /// sampled and could not be told to hold nothing between (search_intervals()), or where rounding
  /// errors make a branch jump from value to value; 0 if none.
  double unresolved = 0.0;
  int num_places = 0;   ///< values at which all eigenvalues were computed and counted
  int num_refined = 0;  ///< values at which one branch was computed for windows and crossings
  std::string method{};  ///< how eigenvalues were found, where the finder says it
};

/// Follows eigenvalues along a parameter (docs/theory.md, 7.4).
///
/// From value to value every eigenvalue is extrapolated and corrected by Newton's method, and their
/// number below a line between two poles is checked with the argument principle. A step is halved
/// until the difference of any two eigenvalues, or of one and its conjugate, changes by less than
/// half of itself: then no two of them can be mistaken for each other, and since branches can turn
/// sharply only where two of them almost meet, the samples resolve them. Where two do meet (the
/// step reaches the resolution), eigenvalues are searched anew and connected by the shapes of their
/// modes, modal_assurance(). Two that coincide to 1e-7, as those of equal bodies, go on together.
///
/// A branch is refined wherever its real part, by the curvature of its samples, may reach zero
/// between two of them. Crossings are then solved for. The result does not depend on the values
/// asked for.
///
/// @param values  strictly ascending, at least one
/// @throws std::invalid_argument if the values or an option are out of range, or as check_pencil()
/// @throws SearchFailure if the eigenvalues at the first value cannot be found, cannot be followed
///         from a value on (by the secular function), or nearly coincide everywhere;
///         NumericalError with the dense method as dense_eigenvalues()
Locus trace_locus(const PencilFamily& family, const std::vector<double>& values,
                  const LocusOptions& options = {});

}  // namespace stridor
