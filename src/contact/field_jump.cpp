#include "contact/field_jump.h"

#include <cmath>

namespace tissue_contact {

FieldJump widestJump(const DistanceGrid& grid) {
  constexpr double kClosed = 2.0;  // spacings
  FieldJump widest;
  double most = kClosed * grid.spacing;
  for (int axis = 0; axis < 3; ++axis) {
    const std::array<int, 3> next = {axis == 0 ? 1 : 0, axis == 1 ? 1 : 0, axis == 2 ? 1 : 0};
    const std::size_t step = grid.index(next[0], next[1], next[2]);
    for (int k = 0; k + next[2] < grid.size[2]; ++k) {
      for (int j = 0; j + next[1] < grid.size[1]; ++j) {
        const float* row = &grid.samples[grid.index(0, j, k)];
        for (int i = 0; i + next[0] < grid.size[0]; ++i) {
          const float here = row[i];
          const float there = row[i + step];
          if ((here < 0.0F) == (there < 0.0F) || !(std::abs(here - there) > most)) continue;
          most = std::abs(here - there);
          widest = {most, 0.5 * (grid.point(i, j, k) + grid.point(i + next[0], j + next[1], k + next[2]))};
        }
      }
    }
  }
  return widest;
}

}  // namespace tissue_contact
