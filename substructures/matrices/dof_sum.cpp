#include "substructures/matrices/dof_sum.hpp"

#include <algorithm>

namespace stridor {

DofSum scaled(const DofSum& sum, double factor) {
  DofSum result;
  if (factor == 0.0) return result;
  for (const DofWeight& dof : sum) result.push_back({dof.dof, factor * dof.weight});
  return result;
}

DofSum gathered(DofSum all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const DofWeight& a, const DofWeight& b) { return a.dof < b.dof; });
  DofSum sum;
  for (const DofWeight& dof : all) {
    if (!sum.empty() && sum.back().dof == dof.dof) {
      sum.back().weight += dof.weight;
    } else {
      sum.push_back(dof);
    }
  }
  std::erase_if(sum, [](const DofWeight& dof) { return dof.weight == 0.0; });
  return sum;
}

void append(DofSum& all, const DofSum& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace stridor
