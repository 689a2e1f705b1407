#include "bench/moreau_jean_kernel.hpp"

namespace stridor::bench {
namespace {

template <class Double>
Double* aligned(Double* values) {
  return static_cast<Double*>(__builtin_assume_aligned(values, 64));
}

}  // namespace

template <int num_ports>
void advance_moreau_jean(const MoreauJeanModes& modes, const double* const* rows,
                         const double* impulses, double new_share, double old_share, double* seen) {
  double* const position = aligned(modes.position);
  double* const velocity = aligned(modes.velocity);
  double* const free = aligned(modes.free);
  const double* const answer = aligned(modes.answer);
  const double* const kept = aligned(modes.kept);
  const double* const pulled = aligned(modes.pulled);
  const double* const loaded = aligned(modes.loaded);
  const double* const r0 = aligned(rows[0]);
  const double* const r1 = aligned(rows[1]);
  const double* const r2 = aligned(rows[num_ports > 2 ? 2 : 0]);
  const double* const r3 = aligned(rows[num_ports > 2 ? 3 : 1]);
  const int count = modes.count / 8 * 8;
  const double p0 = impulses[0];
  const double p1 = impulses[1];
  const double p2 = num_ports > 2 ? impulses[2] : 0.0;
  const double p3 = num_ports > 2 ? impulses[3] : 0.0;
  double s0 = 0.0;
  double s1 = 0.0;
  double s2 = 0.0;
  double s3 = 0.0;
#pragma omp simd reduction(+ : s0, s1, s2, s3)
  for (int i = 0; i < count; ++i) {
    double push = r0[i] * p0 + r1[i] * p1;
    if constexpr (num_ports > 2) push += r2[i] * p2 + r3[i] * p3;
    const double next = free[i] + answer[i] * push;
    const double place = position[i] + new_share * next + old_share * velocity[i];
    const double free_next = kept[i] * next + pulled[i] * place + loaded[i];
    velocity[i] = next;
    position[i] = place;
    free[i] = free_next;
    s0 += r0[i] * free_next;
    s1 += r1[i] * free_next;
    if constexpr (num_ports > 2) {
      s2 += r2[i] * free_next;
      s3 += r3[i] * free_next;
    }
  }
  seen[0] = s0;
  seen[1] = s1;
  if constexpr (num_ports > 2) {
    seen[2] = s2;
    seen[3] = s3;
  }
}

template void advance_moreau_jean<2>(const MoreauJeanModes&, const double* const*, const double*,
                                     double, double, double*);
template void advance_moreau_jean<4>(const MoreauJeanModes&, const double* const*, const double*,
                                     double, double, double*);

}  // namespace stridor::bench
