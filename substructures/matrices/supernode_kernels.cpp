#include "substructures/matrices/supernode_kernels.hpp"

#include <utility>

#include "core/clones.hpp"

namespace stridor {
namespace {

using std::ptrdiff_t;

#define STRIDOR_INLINE inline __attribute__((always_inline))

/// A row of a strip in registers, and in memory.
typedef double Lanes __attribute__((vector_size(64)));
struct __attribute__((packed, may_alias)) StoredLanes {  // at any address; clang forgets `aligned`
  Lanes lanes;
};
static_assert(sizeof(StoredLanes) == strip_width * sizeof(double));

/// Rows or columns whose sums are kept in registers.
constexpr int together = 8;

STRIDOR_INLINE StoredLanes& row(double* strip, ptrdiff_t i) {
  return *reinterpret_cast<StoredLanes*>(strip + strip_width * i);
}
STRIDOR_INLINE const StoredLanes& row(const double* strip, ptrdiff_t i) {
  return *reinterpret_cast<const StoredLanes*>(strip + strip_width * i);
}

/// Calls act(i) for 0 <= i < count with numbers that the compiler knows.
template <int count, class Act>
STRIDOR_INLINE void unrolled(Act&& act) {
  [&]<int... i>(std::integer_sequence<int, i...>) __attribute__((always_inline)) {
    (act(std::integral_constant<int, i>{}), ...);
  }
  (std::make_integer_sequence<int, count>{});
}

#define STRIDOR_EACH [&](auto index) __attribute__((always_inline))

/// Rows `first` to first + together of a column, on the way to the next ones.
///
/// Columns become shorter by one number each, so that a processor does not foresee where the rows
/// of those to come are: they are asked for as long before as memory takes.
STRIDOR_INLINE const double* fetched(const SupernodeView& node, ptrdiff_t c, ptrdiff_t first) {
  constexpr ptrdiff_t ahead = 24;
  const double* to_come = node.column(c + ahead) + first;
  __builtin_prefetch(to_come);
  __builtin_prefetch(to_come + together - 1);
  return node.column(c) + first;
}

template <int count>
STRIDOR_INLINE void lower_part(const SupernodeView& node, ptrdiff_t first, double* own) {
  Lanes sums[count];
  unrolled<count>(STRIDOR_EACH { sums[index] = row(own, first + index).lanes; });
  for (ptrdiff_t c = 0; c < first; ++c) {
    const double* entry = fetched(node, c, first);
    const Lanes x = row(own, c).lanes;
    unrolled<count>(STRIDOR_EACH { sums[index] -= entry[index] * x; });
  }
  for (int i = 0; i < count; ++i) {
    const double* entry = node.column(first + i) + first;
    const Lanes solved = sums[i] / entry[i];
    for (int k = i + 1; k < count; ++k) sums[k] -= entry[k] * solved;
    row(own, first + i).lanes = solved;
  }
}

template <int count>
STRIDOR_INLINE void upper_part(const SupernodeView& node, ptrdiff_t first, double* own) {
  Lanes sums[count];
  unrolled<count>(STRIDOR_EACH { sums[index] = row(own, first + index).lanes; });
  const double* columns[count];
  unrolled<count>(STRIDOR_EACH { columns[index] = node.column(first + index); });
  for (ptrdiff_t r = first + count; r < node.num_columns; ++r) {
    const Lanes x = row(own, r).lanes;
    unrolled<count>(STRIDOR_EACH { sums[index] -= columns[index][r] * x; });
  }
  for (int i = count - 1; i >= 0; --i) {
    const double* entry = columns[i] + first;
    for (int k = i + 1; k < count; ++k) sums[i] -= entry[k] * sums[k];
    sums[i] /= entry[i];
    row(own, first + i).lanes = sums[i];
  }
}

template <int count>
STRIDOR_INLINE void rows_part(const SupernodeView& node, ptrdiff_t first, const int* rows,
                              const double* own, double* strip) {
  Lanes sums[count] = {};
  for (ptrdiff_t c = 0; c < node.num_columns; ++c) {
    const double* entry = fetched(node, c, first);
    const Lanes x = row(own, c).lanes;
    unrolled<count>(STRIDOR_EACH { sums[index] += entry[index] * x; });
  }
  unrolled<count>(STRIDOR_EACH { row(strip, rows[index]).lanes -= sums[index]; });
}

template <int count>
STRIDOR_INLINE void columns_part(const SupernodeView& node, ptrdiff_t offset, ptrdiff_t num_rows,
                                 const int* rows, ptrdiff_t first, const double* strip,
                                 double* own) {
  Lanes sums[count] = {};
  const double* columns[count];
  unrolled<count>(STRIDOR_EACH { columns[index] = node.column(first + index) + offset; });
  for (ptrdiff_t r = 0; r < num_rows; ++r) {
    const Lanes y = row(strip, rows[r]).lanes;
    unrolled<count>(STRIDOR_EACH { sums[index] += columns[index][r] * y; });
  }
  unrolled<count>(STRIDOR_EACH { row(own, first + index).lanes -= sums[index]; });
}

/// Calls act.operator()<n>() for an n that the compiler knows, 1 to `together`.
template <class Act>
STRIDOR_INLINE void with_count(ptrdiff_t count, Act&& act) {
  switch (count) {
    case 1:
      return act.template operator()<1>();
    case 2:
      return act.template operator()<2>();
    case 3:
      return act.template operator()<3>();
    case 4:
      return act.template operator()<4>();
    case 5:
      return act.template operator()<5>();
    case 6:
      return act.template operator()<6>();
    case 7:
      return act.template operator()<7>();
    default:
      return act.template operator()<together>();
  }
}

#define STRIDOR_PART [&]<int n>() __attribute__((always_inline))

STRIDOR_CLONES void solve_lower(const SupernodeView& node, double* own) {
  for (ptrdiff_t first = 0; first < node.num_columns; first += together)
    with_count(
        node.num_columns - first, STRIDOR_PART { lower_part<n>(node, first, own); });
}

STRIDOR_CLONES void solve_upper(const SupernodeView& node, double* own) {
  for (ptrdiff_t end = node.num_columns; end > 0;) {
    const ptrdiff_t first = (end - 1) / together * together;
    with_count(
        end - first, STRIDOR_PART { upper_part<n>(node, first, own); });
    end = first;
  }
}

STRIDOR_CLONES void take_rows(const SupernodeView& node, ptrdiff_t first, ptrdiff_t count,
                              const int* rows, const double* own, double* strip) {
  for (ptrdiff_t k = 0; k < count; k += together)
    with_count(
        count - k, STRIDOR_PART { rows_part<n>(node, first + k, rows + k, own, strip); });
}

STRIDOR_CLONES void take_columns(const SupernodeView& node, ptrdiff_t offset, ptrdiff_t num_rows,
                                 const int* rows, ptrdiff_t first, ptrdiff_t count,
                                 const double* strip, double* own) {
  for (ptrdiff_t k = 0; k < count; k += together)
    with_count(
        count - k,
        STRIDOR_PART { columns_part<n>(node, offset, num_rows, rows, first + k, strip, own); });
}

STRIDOR_CLONES void multiply(ptrdiff_t num_columns, const int* starts, const int* rows,
                             const double* entries, ptrdiff_t stride, const double* x, double* y) {
  for (ptrdiff_t column = 0; column < num_columns; ++column) {
    Lanes sum{};
    for (int k = starts[column]; k < starts[column + 1]; ++k)
      sum += entries[k] * reinterpret_cast<const StoredLanes*>(x + stride * rows[k])->lanes;
    reinterpret_cast<StoredLanes*>(y + stride * column)->lanes = sum;
  }
}

}  // namespace

void solve_lower_triangle(const SupernodeView& node, double* own) {
  solve_lower(node, own);
}

void solve_upper_triangle(const SupernodeView& node, double* own) {
  solve_upper(node, own);
}

void subtract_rows(const SupernodeView& node, ptrdiff_t first, ptrdiff_t count, const int* rows,
                   const double* own, double* strip) {
  take_rows(node, first, count, rows, own, strip);
}

void subtract_columns(const SupernodeView& node, ptrdiff_t offset, ptrdiff_t num_rows,
                      const int* rows, ptrdiff_t first, ptrdiff_t count, const double* strip,
                      double* own) {
  take_columns(node, offset, num_rows, rows, first, count, strip, own);
}

void multiply_columns(ptrdiff_t num_columns, const int* starts, const int* rows,
                      const double* entries, ptrdiff_t stride, const double* x, double* y) {
  multiply(num_columns, starts, rows, entries, stride, x, y);
}

}  // namespace stridor
