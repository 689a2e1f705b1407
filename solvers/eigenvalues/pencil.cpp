#include "solvers/eigenvalues/pencil.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include "coupling/kinematics/face_kinematics.hpp"

namespace stridor {
namespace {

using Complex = std::complex<double>;

[[noreturn]] void reject(const std::string& message) {
  throw std::invalid_argument("pencil: " + message);
}

void check_size(const char* name, const Eigen::MatrixXd& matrix, Eigen::Index rows,
                Eigen::Index columns) {
  if (matrix.rows() != rows || matrix.cols() != columns) {
    reject(fmt::format("{} is {} x {} instead of {} x {}", name, matrix.rows(), matrix.cols(), rows,
                       columns));
  }
  if (!matrix.allFinite()) reject(fmt::format("{} is not finite", name));
}

/// Columns of `source` at `columns`.
Eigen::MatrixXd columns_of(const Eigen::MatrixXd& source,
                           const std::vector<Eigen::Index>& columns) {
  return source(Eigen::all, columns);
}

/// Residual modes of the dropped ones: frequency, damping and ports of each.
struct ResidualModes {
  Eigen::VectorXd omega;
  Eigen::VectorXd damping;
  Eigen::MatrixXd ports;
};

ResidualModes residual_modes(const Eigen::VectorXd& omega, const Eigen::VectorXd& damping,
                             const Eigen::MatrixXd& ports) {
  const Eigen::VectorXd flexibility = omega.array().square().inverse();
  const Eigen::MatrixXd R0 = ports * flexibility.asDiagonal() * ports.transpose();
  // R₀ = F Fᵀ with a column per direction in which the dropped modes move the ports at all.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> directions(R0);
  const Eigen::VectorXd& stretches = directions.eigenvalues();
  const double rounding = 1e-13 * stretches.cwiseAbs().maxCoeff();
  const auto num_modes = static_cast<Eigen::Index>((stretches.array() > rounding).count());
  const Eigen::MatrixXd basis = directions.eigenvectors().rightCols(num_modes) *
                                stretches.tail(num_modes).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd to_basis =
      stretches.tail(num_modes).cwiseSqrt().cwiseInverse().asDiagonal() *
      directions.eigenvectors().rightCols(num_modes).transpose();

  const Eigen::MatrixXd reduced = to_basis * ports;
  const Eigen::VectorXd inertia = flexibility.array().square();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> shapes(
      Eigen::MatrixXd(reduced * inertia.asDiagonal() * reduced.transpose()));
  const Eigen::MatrixXd seen = shapes.eigenvectors().transpose() * reduced;

  ResidualModes residual;
  residual.omega = shapes.eigenvalues().cwiseSqrt().cwiseInverse();
  residual.damping.resize(num_modes);
  for (Eigen::Index r = 0; r < num_modes; ++r) {
    const double R1 =
        (seen.row(r).transpose().array().square() * damping.array() * inertia.array()).sum();
    residual.damping(r) = residual.omega(r) * residual.omega(r) * R1;
  }
  residual.ports = basis * shapes.eigenvectors() * residual.omega.asDiagonal();
  return residual;
}

/// rows · ports. Few rows with few entries, many modes: plain loops along the columns, which are
/// contiguous, where Eigen would set up a blocked product.
void multiply(const Eigen::Ref<const Eigen::MatrixXd>& rows, const Eigen::MatrixXd& ports,
              Eigen::Ref<Eigen::MatrixXd> product) {
  for (Eigen::Index i = 0; i < ports.cols(); ++i) {
    for (Eigen::Index a = 0; a < rows.rows(); ++a) {
      double sum = 0.0;
      for (Eigen::Index port = 0; port < ports.rows(); ++port)
        sum += rows(a, port) * ports(port, i);
      product(a, i) = sum;
    }
  }
}

/// Orthonormal rows that span the rows of both matrices, of which either may be empty or zero.
///
/// By the modified Gram-Schmidt process, the longest row that is left first, each direction taken
/// out twice. By hand, since loci call it in several threads, and BLAS may serve one at a time
/// (core/blas.hpp).
Eigen::MatrixXd common_row_space(const Eigen::MatrixXd& first, const Eigen::MatrixXd& second) {
  constexpr double negligible = 1e-14;
  const Eigen::Index m = std::max(first.cols(), second.cols());
  Eigen::MatrixXd rest(0, m);
  for (const Eigen::MatrixXd* matrix : {&first, &second}) {
    const double size = matrix->size() > 0 ? matrix->norm() : 0.0;
    if (size == 0.0) continue;
    rest.conservativeResize(rest.rows() + matrix->rows(), m);
    rest.bottomRows(matrix->rows()) = *matrix / size;
  }
  Eigen::MatrixXd basis(0, m);
  while (basis.rows() < std::min(rest.rows(), m)) {
    Eigen::Index longest = 0;
    const double length = rest.rowwise().norm().maxCoeff(&longest);
    if (length <= negligible) break;
    const Eigen::RowVectorXd direction = rest.row(longest) / length;
    for (Eigen::Index i = 0; i < rest.rows(); ++i) {
      for (int pass = 0; pass < 2; ++pass) rest.row(i) -= direction.dot(rest.row(i)) * direction;
    }
    rest.row(longest).setZero();
    basis.conservativeResize(basis.rows() + 1, m);
    basis.bottomRows(1) = direction;
  }
  return basis;
}

/// Segment under a point of the undeformed master and the projection on it.
std::pair<int, Projection> undeformed_place(const MasterSurface& surface,
                                            const Eigen::Vector2d& point, int first) {
  const int last = surface.num_segments() - 1;
  int segment = std::clamp(first, 0, last);
  Projection projection = surface.project_undeformed(segment, point);
  while (projection.xi > 1.0 && segment < last) {
    projection = surface.project_undeformed(++segment, point);
  }
  while (projection.xi < 0.0 && segment > 0) {
    projection = surface.project_undeformed(--segment, point);
    if (projection.xi > 1.0) break;  // between two segments that diverge
  }
  return {segment, projection};
}

/// Null vector of a nearly singular matrix, after both its sides are scaled.
Eigen::VectorXcd null_vector(Eigen::MatrixXcd matrix) {
  Eigen::VectorXd column_scale = matrix.cwiseAbs().colwise().maxCoeff().transpose();
  for (double& scale : column_scale) scale = scale > 0.0 ? 1.0 / scale : 1.0;
  matrix = matrix * column_scale.asDiagonal();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    const double largest = matrix.row(i).cwiseAbs().maxCoeff();
    if (largest > 0.0) matrix.row(i) /= largest;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXcd> svd(matrix, Eigen::ComputeFullV);
  return column_scale.asDiagonal() * svd.matrixV().col(matrix.cols() - 1);
}

/// The vector that a nearly singular matrix makes smallest, by inverse iteration.
Eigen::VectorXcd smallest_image(const Eigen::MatrixXcd& matrix) {
  const Eigen::PartialPivLU<Eigen::MatrixXcd> lu(matrix);
  Eigen::VectorXcd vector = Eigen::VectorXcd::NullaryExpr(
      matrix.rows(), [](Eigen::Index i) { return std::polar(1.0, static_cast<double>(i)); });
  constexpr int num_iterations = 3;
  for (int i = 0; i < num_iterations; ++i) vector = lu.solve(vector).normalized().eval();
  return vector;
}

/// Eigenvector from all modes and multipliers, for as many ports as bodies with coupled terms have:
/// the small problem on the ports would divide by modes near their poles, of which there are many.
///
///   [P(s)  B_Eᵀ] [q ]
///   [B_C    0  ] [δλ] = 0,   rows and columns of modes over |s| + ω, those of B_C and B_E over
///                            their lengths
///
/// @param d s² + s c + ω²
/// @return nothing where the matrix is singular to the last digit
std::optional<Eigenvector> eigenvector_of_all_modes(const Pencil& pencil, const ModalRows& rows,
                                                    const Eigen::ArrayXcd& d, Complex s) {
  const Eigen::Index n = pencil.num_modes();
  const Eigen::Index k = rows.num_constraints;
  Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Zero(n + k, n + k);
  matrix.topLeftCorner(n, n) = d.matrix().asDiagonal();
  if (rows.rank > 0) {
    const Eigen::MatrixXcd inputs = rows.inputs.middleRows(k, rows.rank).cast<Complex>() +
                                    s * rows.inputs.bottomRows(rows.rank).cast<Complex>();
    matrix.topLeftCorner(n, n) +=
        inputs.transpose() * rows.outputs.bottomRows(rows.rank).cast<Complex>();
  }
  matrix.topRightCorner(n, k) = rows.inputs.topRows(k).transpose().cast<Complex>();
  matrix.bottomLeftCorner(k, n) = rows.outputs.topRows(k).cast<Complex>();
  Eigen::VectorXd row_scale(n + k), column_scale(n + k);
  row_scale.head(n) = (pencil.omega.array() + std::abs(s)).inverse();
  column_scale.head(n) = row_scale.head(n);
  for (Eigen::Index i = 0; i < k; ++i) {
    const double length_of_row = matrix.row(n + i).head(n).cwiseAbs().dot(row_scale.head(n));
    const double length_of_column = matrix.col(n + i).head(n).cwiseAbs().dot(row_scale.head(n));
    row_scale(n + i) = length_of_row > 0.0 ? 1.0 / length_of_row : 1.0;
    column_scale(n + i) = length_of_column > 0.0 ? 1.0 / length_of_column : 1.0;
  }
  matrix = row_scale.asDiagonal() * matrix * column_scale.asDiagonal();
  const Eigen::VectorXcd right = column_scale.asDiagonal() * smallest_image(matrix);
  const Eigen::VectorXcd left = row_scale.asDiagonal() * smallest_image(matrix.transpose());
  if (!right.allFinite() || !left.allFinite()) return std::nullopt;
  const double length = right.head(n).norm();
  return Eigenvector{right.head(n) / length, left.head(n).conjugate().normalized(),
                     right.tail(k) / length};
}

}  // namespace

double Eigenvalue::frequency() const {
  return s.imag() / (2.0 * std::numbers::pi);
}

void check_pencil(const Pencil& pencil) {
  const Eigen::Index n = pencil.num_modes();
  const Eigen::Index m = pencil.num_ports();
  const Eigen::Index k = pencil.num_constraints();
  check_size("omega", pencil.omega, n, 1);
  check_size("damping", pencil.damping, n, 1);
  check_size("ports", pencil.ports, m, n);
  check_size("compatibility", pencil.compatibility, k, m);
  check_size("equilibrium", pencil.equilibrium, k, m);
  if (pencil.compliance.size() > 0) check_size("compliance", pencil.compliance, k, 1);
  if (pencil.port_stiffness.size() > 0) check_size("port_stiffness", pencil.port_stiffness, m, m);
  if (pencil.port_damping.size() > 0) check_size("port_damping", pencil.port_damping, m, m);
  if (k >= n) reject(fmt::format("{} constraints leave nothing of {} modes", k, n));
  if ((pencil.omega.array() < 0.0).any()) reject("omega is negative");
}

Pencil make_modal_pencil(const System& system) {
  Eigen::Index n = 0;
  for (const SystemBody& body : system.bodies) n += body.modal.size();
  Pencil pencil;
  pencil.omega.resize(n);
  pencil.damping.resize(n);
  Eigen::Index first = 0;
  for (const SystemBody& body : system.bodies) {
    const Eigen::Index size = body.modal.size();
    pencil.omega.segment(first, size) = body.modal.omega;
    pencil.damping.segment(first, size) =
        body.modal.damping.alpha + body.modal.damping.beta * body.modal.omega.array().square();
    if (!body.modal.coupled.is_empty()) pencil.num_body_ports += size;
    first += size;
  }
  const auto k = static_cast<Eigen::Index>(system.contacts.size());
  const Eigen::Index num_contact_ports = first_contact_port(system, static_cast<int>(k));
  const Eigen::Index m = num_contact_ports + pencil.num_body_ports;
  pencil.ports.setZero(m, n);
  pencil.compatibility.setZero(k, m);
  pencil.equilibrium.setZero(k, m);
  if (pencil.num_body_ports == 0) return pencil;
  pencil.port_stiffness.setZero(m, m);
  pencil.port_damping.setZero(m, m);
  Eigen::Index port = num_contact_ports;
  first = 0;
  for (const SystemBody& body : system.bodies) {
    const Eigen::Index size = body.modal.size();
    const CoupledTerms& coupled = body.modal.coupled;
    if (!coupled.is_empty()) {
      pencil.ports.block(port, first, size, size).setIdentity();
      pencil.port_stiffness.block(port, port, size, size) = coupled.position;
      pencil.port_damping.block(port, port, size, size) = coupled.velocity;
      port += size;
    }
    first += size;
  }
  return pencil;
}

Pencil with_springs(const Pencil& pencil) {
  if (pencil.compliance.size() == 0) return pencil;
  Pencil sprung = pencil;
  sprung.compliance.resize(0);
  if (sprung.port_stiffness.size() == 0)
    sprung.port_stiffness.setZero(pencil.num_ports(), pencil.num_ports());
  std::vector<Eigen::Index> rigid;
  for (Eigen::Index i = 0; i < pencil.num_constraints(); ++i) {
    if (pencil.compliance(i) == 0.0) {
      rigid.push_back(i);
      continue;
    }
    sprung.port_stiffness +=
        pencil.equilibrium.row(i).transpose() * (pencil.compatibility.row(i) / pencil.compliance(i));
  }
  sprung.compatibility = pencil.compatibility(rigid, Eigen::all);
  sprung.equilibrium = pencil.equilibrium(rigid, Eigen::all);
  return sprung;
}

void drop_contact_terms(Pencil& pencil) {
  const Eigen::Index num_contact_ports = pencil.num_ports() - pencil.num_body_ports;
  for (Eigen::MatrixXd* terms : {&pencil.port_stiffness, &pencil.port_damping}) {
    if (pencil.num_body_ports == 0) {
      terms->resize(0, 0);
    } else if (terms->size() > 0) {
      terms->topLeftCorner(num_contact_ports, num_contact_ports).setZero();
    }
  }
}

void drop_structural_damping(Pencil& pencil) {
  pencil.damping.setZero();
  const Eigen::Index n = pencil.num_body_ports;
  if (n == 0 || pencil.port_damping.size() == 0) return;
  auto coupled = pencil.port_damping.bottomRightCorner(n, n);
  coupled = 0.5 * (coupled - coupled.transpose()).eval();
}

void drop_contact_damping(Pencil& pencil) {
  const Eigen::Index num_contact_ports = pencil.num_ports() - pencil.num_body_ports;
  if (pencil.port_damping.size() > 0)
    pencil.port_damping.topLeftCorner(num_contact_ports, num_contact_ports).setZero();
}

Eigen::Index first_contact_port(const System& system, int contact) {
  Eigen::Index first = 0;
  for (int i = 0; i < contact; ++i)
    first += system.num_contact_ports(system.contacts[static_cast<std::size_t>(i)]);
  return first;
}

void place_contact(Pencil& pencil, const System& system, int contact, int segment,
                   const ContactRows& rows) {
  const ContactPoint& point = system.contacts[static_cast<std::size_t>(contact)];
  const MasterSurface& surface = system.surfaces[static_cast<std::size_t>(point.surface)];
  const Stencil stencil = surface.stencil(segment);
  const Eigen::Index port = first_contact_port(system, contact);
  pencil.ports.middleRows(port, system.num_contact_ports(point)).setZero();
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const ModalBody& modal = system.bodies[b].modal;
    const auto body = static_cast<int>(b);
    // Mode by mode: the rows of neighbouring nodes lie side by side in a column.
    const auto fill = [&](Eigen::Index at, std::span<const PointRows> watched) {
      for (Eigen::Index i = 0; i < modal.size(); ++i) {
        Eigen::Index row = port + at;
        for (const PointRows& source : watched) {
          pencil.ports(row++, first + i) = modal.rows(source.x, i);
          pencil.ports(row++, first + i) = modal.rows(source.y, i);
        }
      }
    };
    if (body == point.slave_body) fill(0, {&point.slave_rows, 1});
    if (body == surface.body) {
      fill(2, std::span(surface.rows)
                  .subspan(static_cast<std::size_t>(stencil.first),
                           static_cast<std::size_t>(stencil.count)));
    }
    first += modal.size();
  }
  const auto set_row = [&](Eigen::MatrixXd& matrix, const ContactRow& row) {
    for (Eigen::Index i = 0; i < 2; ++i)
      matrix(contact, port + i) = row.slave[static_cast<std::size_t>(i)];
    for (Eigen::Index i = 0; i < 2 * stencil.count; ++i)
      matrix(contact, port + 2 + i) = row.master[static_cast<std::size_t>(i)];
  };
  set_row(pencil.compatibility, rows.compatibility);
  set_row(pencil.equilibrium, rows.equilibrium);
}

void place_face(Pencil& pencil, const System& system, int contact,
                const Eigen::VectorXd& compatibility, const Eigen::VectorXd& equilibrium) {
  const ContactPoint& point = system.contacts[static_cast<std::size_t>(contact)];
  const Eigen::Index port = first_contact_port(system, contact);
  const Eigen::Index num_ports = system.num_contact_ports(point);
  pencil.ports.middleRows(port, num_ports).setZero();
  Eigen::Index first = 0;
  for (std::size_t b = 0; b < system.bodies.size(); ++b) {
    const ModalBody& modal = system.bodies[b].modal;
    const auto columns = Eigen::seqN(first, modal.size());
    if (static_cast<int>(b) == point.face->body) {
      for (Eigen::Index k = 0; k < num_face_rows; ++k)
        pencil.ports(port + k, columns) =
            modal.rows.row(point.face->rows[static_cast<std::size_t>(k)]);
    }
    if (static_cast<int>(b) == point.slave_body) {
      const std::array rows{point.slave_rows.x, point.slave_rows.y, point.slave_rows.z};
      for (Eigen::Index k = num_face_rows; k < num_ports; ++k)
        pencil.ports(port + k, columns) +=
            modal.rows.row(rows[static_cast<std::size_t>(k - num_face_rows)]);
    }
    first += modal.size();
  }
  pencil.compatibility.row(contact).segment(port, num_ports) = compatibility.transpose();
  pencil.equilibrium.row(contact).segment(port, num_ports) = equilibrium.transpose();
}

void place_undeformed(Pencil& pencil, const System& system, double drive_displacement,
                      double friction, double direction) {
  for (std::size_t c = 0; c < system.contacts.size(); ++c) {
    const ContactPoint& point = system.contacts[c];
    if (point.face) {
      const FaceKinematics face = make_face_kinematics(*point.face);
      const int num_ports = system.num_contact_ports(point);
      place_face(pencil, system, static_cast<int>(c), -face.normal.head(num_ports),
                 -(face.normal + friction * face.along).head(num_ports));
      continue;
    }
    const MasterSurface& surface = system.surfaces[static_cast<std::size_t>(point.surface)];
    // The surface may follow a drive, too; seen from it, only the difference moves the slave.
    const Eigen::Vector2d slave =
        point.slave_position + Eigen::Vector2d(system.path_share(point) * drive_displacement, 0.0);
    const auto [segment, projection] = undeformed_place(surface, slave, point.first_segment);
    constexpr double rounding = 1e-9;
    const bool is_off = (segment == 0 && projection.xi < -rounding) ||
                        (segment == surface.num_segments() - 1 && projection.xi > 1.0 + rounding);
    if (is_off && !surface.is_endless) {
      throw std::invalid_argument(
          fmt::format("pencil: contact '{}' is beyond the end of its master at a drive "
                      "displacement of {:g} m",
                      point.name, drive_displacement));
    }
    place_contact(pencil, system, static_cast<int>(c), segment,
                  make_rows(projection, friction, direction));
  }
}

Pencil with_residual_modes(const Pencil& pencil, double cutoff) {
  check_pencil(pencil);
  if (!(cutoff > 0.0)) reject(fmt::format("the cut-off must be positive, is {:g} rad/s", cutoff));
  std::vector<Eigen::Index> kept;
  std::vector<Eigen::Index> dropped;
  const auto is_coupled = [&](Eigen::Index i) {
    return !pencil.ports.col(i).tail(pencil.num_body_ports).isZero(0.0);
  };
  for (Eigen::Index i = 0; i < pencil.num_modes(); ++i) {
    (pencil.omega(i) > cutoff && !is_coupled(i) ? dropped : kept).push_back(i);
  }
  if (dropped.empty()) return pencil;
  const Eigen::Index num_contact_ports = pencil.num_ports() - pencil.num_body_ports;
  const ResidualModes residual =
      residual_modes(pencil.omega(dropped), pencil.damping(dropped),
                     columns_of(pencil.ports.topRows(num_contact_ports), dropped));
  const auto num_kept = static_cast<Eigen::Index>(kept.size());
  const Eigen::Index n = num_kept + residual.omega.size();
  Pencil reduced = pencil;
  reduced.omega.resize(n);
  reduced.damping.resize(n);
  reduced.ports.resize(pencil.num_ports(), n);
  reduced.omega << pencil.omega(kept), residual.omega;
  reduced.damping << pencil.damping(kept), residual.damping;
  reduced.ports.setZero();
  reduced.ports.leftCols(num_kept) = columns_of(pencil.ports, kept);
  reduced.ports.topRightCorner(num_contact_ports, residual.omega.size()) = residual.ports;
  check_pencil(reduced);
  return reduced;
}

ModalRows modal_rows(const Pencil& pencil) {
  ModalRows rows;
  rows.num_constraints = pencil.num_constraints();
  const Eigen::Index k = rows.num_constraints;
  const Eigen::MatrixXd V = common_row_space(pencil.port_stiffness, pencil.port_damping);
  rows.rank = V.rows();
  const Eigen::Index r = rows.rank;
  rows.outputs.resize(k + r, pencil.num_modes());
  multiply(pencil.compatibility, pencil.ports, rows.outputs.topRows(k));
  rows.inputs.setZero(k + 2 * r, pencil.num_modes());
  multiply(pencil.equilibrium, pencil.ports, rows.inputs.topRows(k));
  if (r > 0) {
    multiply(V, pencil.ports, rows.outputs.bottomRows(r));
    const auto fill = [&](const Eigen::MatrixXd& matrix, Eigen::Index first) {
      if (matrix.size() == 0) return;
      const Eigen::MatrixXd combined = V.lazyProduct(matrix.transpose());
      multiply(combined, pencil.ports, rows.inputs.middleRows(first, r));
    };
    fill(pencil.port_stiffness, k);
    fill(pencil.port_damping, k + r);
  }
  return rows;
}

Eigenvector eigenvector(const Pencil& pencil, Complex s) {
  check_pencil(pencil);
  const ModalRows rows = modal_rows(pencil);
  const Eigen::Index n = pencil.num_modes();
  const Eigen::Index k = rows.num_constraints;
  const Eigen::Index size = k + rows.rank;
  const Eigen::ArrayXcd d = s * s + s * pencil.damping.array().cast<Complex>() +
                            pencil.omega.array().square().cast<Complex>();
  constexpr Eigen::Index most_rows = 24;
  if (size > most_rows) {
    if (const auto vector = eigenvector_of_all_modes(pencil, rows, d, s)) return *vector;
  }
  // Modes at their pole would be divided by next to nothing: they stay unknowns.
  Eigen::Index nearest = 0;
  d.abs().minCoeff(&nearest);
  std::vector<Eigen::Index> near;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i == nearest || std::abs(d(i)) < 1e-8 * std::norm(s)) near.push_back(i);
  }
  Eigen::ArrayXcd inverse = d.inverse();
  for (const Eigen::Index i : near) inverse(i) = 0.0;

  const Eigen::MatrixXcd outputs = rows.outputs.cast<Complex>();
  Eigen::MatrixXcd inputs = rows.inputs.topRows(size).cast<Complex>();
  if (rows.rank > 0) inputs.bottomRows(rows.rank) += s * rows.inputs.bottomRows(rows.rank);
  const auto num_near = static_cast<Eigen::Index>(near.size());
  Eigen::MatrixXcd bordered = Eigen::MatrixXcd::Zero(size + num_near, size + num_near);
  if (size > 0) {
    bordered.topLeftCorner(size, size) =
        outputs * inverse.matrix().asDiagonal() * inputs.transpose();
  }
  bordered.topLeftCorner(size, size).diagonal().tail(rows.rank).array() += 1.0;
  for (Eigen::Index j = 0; j < num_near; ++j) {
    const Eigen::Index i = near[static_cast<std::size_t>(j)];
    bordered.block(0, size + j, size, 1) = outputs.col(i);
    bordered.block(size + j, 0, 1, size) = -inputs.col(i).transpose();
    bordered(size + j, size + j) = d(i);
  }

  Eigenvector vector;
  const Eigen::VectorXcd right = null_vector(bordered);
  const Eigen::VectorXcd left = null_vector(bordered.transpose());
  vector.right = Eigen::VectorXcd::Zero(n);
  Eigen::VectorXcd transposed = Eigen::VectorXcd::Zero(n);
  if (size > 0) {
    vector.right -= (inverse * (inputs.transpose() * right.head(size)).array()).matrix();
    transposed -= (inverse * (outputs.transpose() * left.head(size)).array()).matrix();
  }
  for (Eigen::Index j = 0; j < num_near; ++j) {
    const Eigen::Index i = near[static_cast<std::size_t>(j)];
    vector.right(i) = -right(size + j);
    transposed(i) = left(size + j);
  }
  const double length = vector.right.norm();
  vector.right /= length;
  vector.force = right.head(k) / length;
  vector.left = transposed.conjugate().normalized();
  return vector;
}

double relative_residual(const Pencil& pencil, Complex s, const Eigen::VectorXcd& right) {
  const Eigen::VectorXd scale = (pencil.omega.array() + std::abs(s)).inverse();
  const auto scaled_norm = [&](const Eigen::VectorXcd& term) {
    return scale.cwiseProduct(term.cwiseAbs()).norm();
  };
  const Eigen::VectorXcd y = pencil.ports * right;
  Eigen::VectorXcd port_force = Eigen::VectorXcd::Zero(pencil.num_ports());
  if (pencil.port_stiffness.size() > 0) port_force += pencil.port_stiffness * y;
  if (pencil.port_damping.size() > 0) port_force += s * (pencil.port_damping * y);
  const Eigen::VectorXcd inertia = s * s * right;
  const Eigen::VectorXcd damping = s * pencil.damping.cast<Complex>().cwiseProduct(right);
  const Eigen::VectorXcd stiffness =
      pencil.omega.array().square().matrix().cast<Complex>().cwiseProduct(right);
  const Eigen::VectorXcd contact = pencil.ports.transpose() * port_force;
  const Eigen::VectorXcd without = inertia + damping + stiffness + contact;
  const double terms =
      scaled_norm(inertia) + scaled_norm(damping) + scaled_norm(stiffness) + scaled_norm(contact);

  const Eigen::MatrixXd force_columns =
      scale.asDiagonal() * (pencil.equilibrium * pencil.ports).transpose();
  const Eigen::VectorXcd target = scale.cast<Complex>().cwiseProduct(without);
  Eigen::VectorXcd rest = target;
  if (force_columns.cols() > 0) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(force_columns);
    rest.real() -= force_columns * qr.solve(Eigen::VectorXd(target.real()));
    rest.imag() -= force_columns * qr.solve(Eigen::VectorXd(target.imag()));
  }
  const Eigen::MatrixXd gap_rows = pencil.compatibility * pencil.ports;
  const double gaps = (gap_rows * right).norm();
  const double gap_terms = (gap_rows.cwiseAbs() * right.cwiseAbs()).norm();
  return rest.norm() / (terms + (target - rest).norm()) +
         (gap_terms > 0.0 ? gaps / gap_terms : 0.0);
}

double modal_assurance(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
  return std::norm(a.dot(b)) / (a.squaredNorm() * b.squaredNorm());
}

}  // namespace stridor
