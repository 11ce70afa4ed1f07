/// @file
/// Room `tissue`, private: an elastic body some of whose nodes are attached to the world by springs. Any elasticity and
/// springs in; an elasticity whose forces, stiffness, damping and energy have the springs in them out.
#pragma once

#include <memory>
#include <vector>

#include "tissue_contact/tissue/elasticity.h"

namespace tissue_contact {

/// From a node to where it rests: f = -k (x - x_rest), W = k/2 |x - x_rest|^2.
struct NodeSpring {
  int node = 0;            ///< a free one
  double stiffness = 0.0;  ///< k, N/m
};

/// K has k I more in the diagonal block of each attached node, D where there is one damping_s k I, so that a step of
/// implicit Euler is implicit in the springs too. A tissue without attachments does without this class.
class AttachedElasticity : public Elasticity {
 public:
  /// @param body its nodes rest at `rest`, 3 x nodes, m, world frame.
  /// @param springs each node at most once.
  /// @param damping_s for bodies whose State has a damping matrix; else D = stiffness_s K is the caller's, springs
  ///   included.
  AttachedElasticity(std::unique_ptr<const Elasticity> body, const NodalVectors& rest, std::vector<NodeSpring> springs,
                     double damping_s);

  std::unique_ptr<State> makeState() const override;
  std::unique_ptr<State> makeStateAt(const NodalVectors& x) const override;
  std::unique_ptr<State> makeStateAfter(const State& before, const NodalVectors& x) const override;
  void update(const NodalVectors& x, State& state, NodalVectors& forces) const override;
  void holdStill(const std::vector<bool>& still, const NodalVectors& x, State& state) const override;
  bool hasMemory() const override { return body_->hasMemory(); }
  double energy(const NodalVectors& x) const override;

 private:
  struct AttachedState;

  std::unique_ptr<State> attach(std::unique_ptr<State> body) const;

  template <typename Work>
  void withoutSprings(AttachedState& state, const Work& work) const;

  std::unique_ptr<const Elasticity> body_;
  std::vector<NodeSpring> springs_;
  NodalVectors anchors_;  ///< where each spring has no force, 3 x springs, m
  double damping_s_;
};

}  // namespace tissue_contact
