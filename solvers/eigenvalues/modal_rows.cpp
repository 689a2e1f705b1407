// The contacts of a pencil as its modes feel them.
#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "solvers/eigenvalues/pencil.hpp"

namespace stridor {
namespace {

/// rows · ports. Few rows with few entries, many modes: plain loops along the columns, which are
/// contiguous, where Eigen would set up a blocked product.
void multiply(const Eigen::Ref<const Eigen::MatrixXd>& rows, const Eigen::MatrixXd& ports,
              Eigen::Ref<Eigen::MatrixXd> product) {
  const Eigen::MatrixXd columns = rows.transpose();
  for (Eigen::Index i = 0; i < ports.cols(); ++i) {
    for (Eigen::Index a = 0; a < columns.cols(); ++a) {
      double sum = 0.0;
      for (Eigen::Index port = 0; port < ports.rows(); ++port)
        sum += columns(port, a) * ports(port, i);
      product(a, i) = sum;
    }
  }
}

/// Sets of ports between which neither matrix has an entry, each ascending.
std::vector<std::vector<Eigen::Index>> separate_ports(const Eigen::MatrixXd& first,
                                                      const Eigen::MatrixXd& second) {
  const Eigen::Index m = std::max(first.cols(), second.cols());
  std::vector<Eigen::Index> joined_to(static_cast<std::size_t>(m));
  std::iota(joined_to.begin(), joined_to.end(), Eigen::Index{0});
  const auto root_of = [&](Eigen::Index port) {
    while (joined_to[static_cast<std::size_t>(port)] != port)
      port = joined_to[static_cast<std::size_t>(port)] =
          joined_to[static_cast<std::size_t>(joined_to[static_cast<std::size_t>(port)])];
    return port;
  };
  for (const Eigen::MatrixXd* matrix : {&first, &second}) {
    for (Eigen::Index column = 0; column < matrix->cols(); ++column) {
      for (Eigen::Index row = 0; row < matrix->rows(); ++row) {
        if ((*matrix)(row, column) == 0.0) continue;
        const Eigen::Index a = root_of(row);
        const Eigen::Index b = root_of(column);
        joined_to[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      }
    }
  }
  std::vector<std::vector<Eigen::Index>> of_root(static_cast<std::size_t>(m));
  for (Eigen::Index port = 0; port < m; ++port)
    of_root[static_cast<std::size_t>(root_of(port))].push_back(port);
  std::erase_if(of_root, [](const auto& ports) { return ports.empty(); });
  return of_root;
}

/// Orthonormal rows that span the rows of both matrices, of which either may be empty or zero.
///
/// By the modified Gram-Schmidt process, the longest row that is left first, each direction taken
/// out twice. By hand, since loci call it in several threads, and BLAS may serve one at a time
/// (core/blas.hpp). Rows are kept as columns, which are contiguous: bodies of meshes that spin have
/// some hundred ports. Ports that nothing joins are taken for themselves: hundreds of contacts have
/// thousands.
Eigen::MatrixXd common_row_space(const Eigen::MatrixXd& first, const Eigen::MatrixXd& second) {
  constexpr double negligible = 1e-14;
  struct Direction {
    double length = 0.0;
    const std::vector<Eigen::Index>* ports = nullptr;
    Eigen::VectorXd components;
  };
  const auto sets = separate_ports(first, second);
  std::vector<Direction> found;
  const double first_size = first.size() > 0 ? first.norm() : 0.0;
  const double second_size = second.size() > 0 ? second.norm() : 0.0;
  for (const std::vector<Eigen::Index>& ports : sets) {
    const auto size = static_cast<Eigen::Index>(ports.size());
    Eigen::MatrixXd rest(size, 0);
    for (const auto& [matrix, norm] :
         {std::pair(&first, first_size), std::pair(&second, second_size)}) {
      if (norm == 0.0) continue;
      rest.conservativeResize(size, rest.cols() + size);
      rest.rightCols(size) = (*matrix)(ports, ports).transpose() / norm;
    }
    for (Eigen::Index rank = 0; rank < std::min(rest.cols(), size); ++rank) {
      Eigen::Index longest = 0;
      const double length = rest.colwise().norm().maxCoeff(&longest);
      if (length <= negligible) break;
      const Eigen::VectorXd direction = rest.col(longest) / length;
      for (Eigen::Index i = 0; i < rest.cols(); ++i) {
        for (int pass = 0; pass < 2; ++pass) rest.col(i) -= direction.dot(rest.col(i)) * direction;
      }
      rest.col(longest).setZero();
      found.push_back({length, &ports, direction});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Direction& a, const Direction& b) { return a.length > b.length; });
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(found.size()),
                                                std::max(first.cols(), second.cols()));
  for (std::size_t row = 0; row < found.size(); ++row)
    basis(static_cast<Eigen::Index>(row), *found[row].ports) = found[row].components.transpose();
  return basis;
}

}  // namespace

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

}  // namespace stridor
