#include "tissue/neo_hookean_stiffness.h"

#include "tissue/block_slots.h"

namespace tissue_contact {

void NeoHookeanStiffness::place(const Share& share) {
  for (std::size_t i = 0; i < 9; ++i) lanes_.F[i][count_] = share.F[i][share.lane];
  lanes_.volume[count_] = share.volume_m3;
  lanes_.lambda[count_] = share.material.lambda;
  lanes_.mu[count_] = share.material.mu;
  lanes_.pressure[count_] = share.patch.pressure;
  lanes_.flat_modulus[count_] = share.patch.flat_modulus;
  waiting_[count_++] = {share.nodes, share.slots, share.damping_s};
  if (count_ == kLanes) addAll();
}

void NeoHookeanStiffness::addAll() {
  std::size_t most = 0;
  for (std::size_t lane = 0; lane < count_; ++lane) most = std::max(most, waiting_[lane].nodes);
  if (most == 0) return;
  const unsigned char failed =
      computeTangents(lanes_, scratch_.gradients.data(), most, scratch_.turned.data(), scratch_.blocks.data());
  for (std::size_t lane = 0; lane < count_; ++lane) addTo(lane, most, (failed >> lane & 1) != 0);
  count_ = 0;
}

void NeoHookeanStiffness::addTo(std::size_t lane, std::size_t most, bool failed) {
  const auto matrix = [lane](const MatrixBatch& batch) {
    Matrix3 one;
    for (std::size_t i = 0; i < 9; ++i) one.data()[i] = batch[i][lane];
    return one;
  };
  const auto add = [&](const auto& blockOf) {
    const Waiting& to = waiting_[lane];
    const int* next = to.slots;
    for (std::size_t n = 0; n < to.nodes; ++n) {
      for (std::size_t m = n; m < to.nodes; ++m) {
        const int slot = *next++;
        if (slot >= 0) addBlock(n == m, slot, blockOf(n, m), to.damping_s, state_.stiffness, state_.damping);
      }
    }
  };
  if (!failed) {
    add([&](std::size_t n, std::size_t m) { return matrix(scratch_.blocks[n * (2 * most - n - 1) / 2 + m]); });
    return;
  }
  const Tangent simple(
      {matrix(lanes_.F), {lanes_.lambda[lane], lanes_.mu[lane]}, {lanes_.pressure[lane], lanes_.flat_modulus[lane]}});
  const auto gradient = [&](std::size_t n) {
    const GradientLanes& at = scratch_.gradients[n];
    return Vector3(at[0][lane], at[1][lane], at[2][lane]);
  };
  add([&](std::size_t n, std::size_t m) -> Matrix3 {
    return lanes_.volume[lane] * simple.block(gradient(n), gradient(m));
  });
}

}  // namespace tissue_contact
