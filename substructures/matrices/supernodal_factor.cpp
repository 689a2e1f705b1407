#include "substructures/matrices/supernodal_factor.hpp"

#include <algorithm>
#include <cstring>
#include <new>

namespace stridor {
namespace {

/// The lower triangle of a symmetric matrix, or of its pattern, by columns.
class LowerTriangle {
 public:
  LowerTriangle(std::size_t size, std::size_t num_entries, bool has_values)
      : starts_{0},
        // CHOLMOD takes no arrays of nothing.
        rows_(std::max<std::size_t>(num_entries, 1)),
        values_(has_values ? rows_.size() : 0) {
    starts_.reserve(size + 1);
  }

  void append(int row) { rows_[count_++] = row; }
  void append(int row, double value) {
    values_[count_] = value;
    append(row);
  }
  void finish_column() { starts_.push_back(static_cast<int>(count_)); }

  cholmod_sparse view() {
    cholmod_sparse matrix{};
    matrix.nrow = matrix.ncol = starts_.size() - 1;
    matrix.nzmax = count_;
    matrix.p = starts_.data();
    matrix.i = rows_.data();
    matrix.x = values_.empty() ? nullptr : values_.data();
    matrix.stype = -1;
    matrix.itype = CHOLMOD_INT;
    matrix.xtype = values_.empty() ? CHOLMOD_PATTERN : CHOLMOD_REAL;
    matrix.dtype = CHOLMOD_DOUBLE;
    matrix.packed = 1;
    return matrix;
  }

 private:
  std::vector<int> starts_, rows_;
  std::vector<double> values_;
  std::size_t count_ = 0;
};

std::span<const int> rows_of_column(const SparseMatrix& matrix, int column) {
  const int* starts = matrix.outerIndexPtr();
  const int count = matrix.isCompressed() ? starts[column + 1] - starts[column]
                                          : matrix.innerNonZeroPtr()[column];
  return {matrix.innerIndexPtr() + starts[column], static_cast<std::size_t>(count)};
}

/// DoFs whose columns have the same rows, such as those of one node, and the graph between them.
class DofGroups {
 public:
  /// @param dofs ascending
  DofGroups(const SparseMatrix& matrix, std::span<const int> dofs)
      : group_of_(static_cast<std::size_t>(matrix.cols()), -1) {
    for (std::size_t k = 0; k < dofs.size(); ++k) {
      if (k == 0 || !std::ranges::equal(rows_of_column(matrix, dofs[k]),
                                        rows_of_column(matrix, dofs[k - 1])))
        first_.push_back(static_cast<int>(k));
      group_of_[static_cast<std::size_t>(dofs[k])] = static_cast<int>(first_.size()) - 1;
    }
    num_groups_ = first_.size();
    first_.push_back(static_cast<int>(dofs.size()));
  }

  std::size_t size() const { return num_groups_; }
  /// The part of `dofs` that is of a group.
  std::span<const int> members(std::span<const int> dofs, int group) const {
    const auto g = static_cast<std::size_t>(group);
    return dofs.subspan(static_cast<std::size_t>(first_[g]),
                        static_cast<std::size_t>(first_[g + 1] - first_[g]));
  }

  LowerTriangle graph(const SparseMatrix& matrix, std::span<const int> dofs) const {
    std::size_t num_entries = 0;
    for_entries(matrix, dofs, [&](int) { ++num_entries; }, [] {});
    LowerTriangle graph(num_groups_, num_entries, false);
    for_entries(
        matrix, dofs, [&](int row) { graph.append(row); }, [&] { graph.finish_column(); });
    return graph;
  }

 private:
  template <typename Entry, typename End>
  void for_entries(const SparseMatrix& matrix, std::span<const int> dofs, Entry&& entry,
                   End&& end) const {
    for (std::size_t column = 0; column < num_groups_; ++column) {
      int last = static_cast<int>(column) - 1;
      for (const int dof : rows_of_column(matrix, dofs[static_cast<std::size_t>(first_[column])])) {
        const int row = group_of_[static_cast<std::size_t>(dof)];
        if (row > last) entry(last = row);
      }
      end();
    }
  }

  std::vector<int> group_of_;  ///< of each DoF; -1 of those that are left out
  std::vector<int> first_;     ///< place of the first of each group among the DoFs, and the end
  std::size_t num_groups_ = 0;
};

/// An order of the DoFs that keeps L sparse: one of their groups, which are fewer by two or three
/// times, and have fewer neighbours by four or nine.
std::vector<int> fill_reducing_order(const SparseMatrix& matrix, std::span<const int> dofs) {
  const DofGroups groups(matrix, dofs);
  LowerTriangle graph = groups.graph(matrix, dofs);
  Cholmod cholmod;
  cholmod->supernodal = CHOLMOD_SIMPLICIAL;
  // Minimum degree, and nested dissection as well where that fills much: down to so few groups as
  // leave less fill than METIS, which stops at 200 and orders these by themselves.
  constexpr std::size_t undivided = 40;
  constexpr int dissection = 2;  // its place among the methods that CHOLMOD tries by itself
  cholmod->nmethods = 0;
  cholmod->default_nesdis = 1;
  cholmod->method[dissection].nd_small = undivided;
  cholmod_sparse view = graph.view();
  cholmod_factor* factor = cholmod_analyze(&view, cholmod.get());
  if (factor == nullptr) throw std::bad_alloc();
  std::vector<int> order;
  order.reserve(dofs.size());
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const auto members = groups.members(dofs, static_cast<const int*>(factor->Perm)[k]);
    order.insert(order.end(), members.begin(), members.end());
  }
  cholmod_free_factor(&factor, cholmod.get());
  return order;
}

/// The lower triangle of the rows and columns of `order`, in that order.
LowerTriangle ordered_triangle(const SparseMatrix& matrix, std::span<const int> order) {
  std::vector<int> place(static_cast<std::size_t>(matrix.cols()), -1);
  for (std::size_t k = 0; k < order.size(); ++k)
    place[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
  std::size_t num_entries = 0;
  for (const int dof : order) {
    const int column = place[static_cast<std::size_t>(dof)];
    num_entries += static_cast<std::size_t>(
        std::ranges::count_if(rows_of_column(matrix, dof), [&](int row) {
          return place[static_cast<std::size_t>(row)] >= column;
        }));
  }
  LowerTriangle triangle(order.size(), num_entries, true);
  for (const int dof : order) {
    const int column = place[static_cast<std::size_t>(dof)];
    for (SparseMatrix::InnerIterator entry(matrix, dof); entry; ++entry) {
      const int row = place[static_cast<std::size_t>(entry.row())];
      if (row >= column) triangle.append(row, entry.value());
    }
    triangle.finish_column();
  }
  return triangle;
}

}  // namespace

Cholmod::Cholmod() {
  cholmod_start(&common_);
  common_.print = 0;  // its warnings come back as exceptions here
}

bool SupernodalFactor::factorise(const SparseMatrix& matrix, std::span<const int> dofs) {
  dofs_ = fill_reducing_order(matrix, dofs);
  // CHOLMOD would hold further copies if it brought the matrix into order itself.
  LowerTriangle triangle = ordered_triangle(matrix, dofs_);
  cholmod_->supernodal = CHOLMOD_SUPERNODAL;
  cholmod_->method[0].ordering = CHOLMOD_NATURAL;
  cholmod_->nmethods = 1;
  cholmod_->postorder = 0;
  cholmod_sparse view = triangle.view();
  factor_ = cholmod_analyze(&view, cholmod_.get());
  if (factor_ == nullptr) throw std::bad_alloc();
  cholmod_factorize(&view, factor_, cholmod_.get());
  if (cholmod_->status < CHOLMOD_OK) throw std::bad_alloc();
  if (factor_->minor < factor_->n) return false;
  drop_upper_triangles();
  return true;
}

/// Moves the columns of L together. CHOLMOD stores supernodes as rectangles, of which the part
/// above the diagonal is a tenth to a sixth of the whole in bodies in space.
void SupernodalFactor::drop_upper_triangles() {
  auto* const begin = static_cast<double*>(factor_->x);
  auto* const start = static_cast<int*>(factor_->px);
  double* to = begin;
  for (std::size_t k = 0; k < factor_->nsuper; ++k) {
    const Supernode node = supernode(k);
    start[k] = static_cast<int>(to - begin);
    for (Eigen::Index column = 0; column < node.num_columns; ++column) {
      const auto count = static_cast<std::size_t>(node.num_rows() - column);
      std::memmove(to, node.entries + column * (node.num_rows() + 1), count * sizeof(double));
      to += count;
    }
  }
  const auto num_entries = static_cast<std::size_t>(to - begin);
  start[factor_->nsuper] = static_cast<int>(num_entries);
  factor_->x =
      cholmod_realloc(num_entries, sizeof(double), factor_->x, &factor_->xsize, cholmod_.get());
}

Supernode SupernodalFactor::supernode(std::size_t k) const {
  const auto* column = static_cast<const int*>(factor_->super) + k;
  const auto* row = static_cast<const int*>(factor_->pi) + k;
  const auto* entry = static_cast<const int*>(factor_->px) + k;
  const auto* rows = static_cast<const int*>(factor_->s);
  return {{rows + row[0], rows + row[1]},
          column[1] - column[0],
          static_cast<const double*>(factor_->x) + entry[0]};
}

}  // namespace stridor
