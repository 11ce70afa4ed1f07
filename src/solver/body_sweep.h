/// @file
/// Room `solver`, private: Gauss-Seidel sweeps over the nodes of one body, four at a time, with the impulses of
/// contacts held.
///
/// A sweep visits the slices of the body's BlockPattern in their order, which gives what visiting node after node
/// gives. A sweep forth leaves sum_{j<i} A_ij v_j of every node, which the sweep back then need not compute (Conrad &
/// Wallach, "Alternating Methods for Sets of Linear Equations", Numer. Math. 32 (1979) 105-108).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "core/slice_product.h"
#include "solver/coarse_motions.h"
#include "solver/deflation.h"
#include "solver/rigid_motions.h"
#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// Of the nodes that a sweep has visited and no contact holds: b + J'lambda - A v as it was when their turn came.
struct DefectsMet {
  double squared = 0.0;           ///< sum of squares, (N s)^2
  Vector3 sum = Vector3::Zero();  ///< N s

  DefectsMet& operator+=(const DefectsMet& other) {
    squared += other.squared;
    sum += other.sum;
    return *this;
  }
};

class BodySweep {
 public:
  /// Begins a step, without impulses. Allocates only for a body of another size than before. @param body must stay until the next one begins.
  void prepare(const BodySystem& body);

  /// Begins a step in which the body sleeps: none of its nodes moves, and impulses on it are not kept.
  void rest() { body_ = nullptr; }

  /// P_i^-1 of a node, 1/kg; 0 if it does not move.
  Matrix3 inverse(int node) const;

  /// Adds to J'lambda of a node, N s.
  void addImpulse(int node, const Vector3& impulse_W);

  /// After the first sweep forth of a step, before follow(): along what to go in deflate(), 3 x nodes, m/s; nothing of another
  /// size. @param excluded nodes that contacts may move.
  void beginDeflation(const NodalVectors& u, const std::vector<int>& excluded);

  /// After a sweep forth, before follow(): from now on deflate() moves the body's stiff parts as well. @param excluded nodes that contacts
  /// may move, ascending.
  void beginRigidMotions(const std::vector<int>& excluded);

  /// From now on deflate() moves the body along its coarse motions as well. @param excluded nodes that contacts may move, ascending.
  void beginCoarseMotions(const std::vector<int>& excluded);

  /// A contact has moved a node by `change` (m/s) since the sweep forth.
  void follow(int node, const Vector3& change);

  /// Between a sweep forth and the sweep back, with what contacts moved followed (Deflation, RigidMotions, CoarseMotions). @param v m/s.
  void deflate(NodalVectors& v);

  /// Ends a step. @param forth the last sweep was one forth; what contacts moved since counts as found by it.
  /// @param u becomes what the step was slow to find, m/s; stays as it is where one sweep forth was all.
  void finish(bool forth, const NodalVectors& v, NodalVectors& u);

  /// @param v 3 x nodes, m/s.
  /// @param held what BlockPattern::lane_of gives for the nodes that a contact may hold, ascending.
  /// @param hold called with each of them after its step; true: its contact holds it, so that its defect does not count.
  template <class Hold>
  DefectsMet sweep(bool forward, const std::vector<int>& held, NodalVectors& v, const Hold& hold) {
    if (forward) std::fill(lower_.begin(), lower_.end(), PaddedVector{});
    pad(v, v_);
    if (forward) deflation_.beginForth(v_);
    if (forward) rigid_motions_.beginForth();
    const int slices = pattern().slices();
    int begin = 0;  // of what is left
    int end = slices;
    DefectsMet met;
    for (std::size_t done = 0; done < held.size();) {
      const auto next = [&] { return held[forward ? done : held.size() - 1 - done]; };
      const int slice = next() / kLanes;
      met += forward ? forth(begin, slice) : back(slice + 1, end);
      SliceDefects slice_met = relaxSlice(slice);
      for (; done < held.size() && next() / kLanes == slice; ++done) {
        const int node = pattern().rows[next()];
        v.col(node) = vectorOf(v_[node]);
        if (hold(node)) slice_met.forget(next() % kLanes);
        vectorOf(v_[node]) = v.col(node);
      }
      met += slice_met.total();
      if (forward) carrySlice(slice);
      (forward ? begin : end) = forward ? slice + 1 : slice;
    }
    met += forward ? forth(begin, end) : back(begin, end);
    unpad(v_, v);
    return met;
  }

 private:
  /// Of each row of a slice.
  struct SliceDefects {
    std::array<double, kLanes> squares{};
    SliceVectors defects{};

    void forget(std::size_t lane) {
      squares[lane] = 0.0;
      for (auto& component : defects.at) component[lane] = 0.0;
    }
    DefectsMet total() const;
  };

  const BlockPattern& pattern() const { return *body_->K->pattern; }
  void prepareSlices();
  void correctCoarsely();
  Deflation::Products measure(PaddedVectors& u, PaddedVectors& lower) const;
  DefectsMet forth(int begin, int end);
  DefectsMet back(int begin, int end);
  SliceDefects relaxSlice(int slice);
  void carrySlice(int slice);

  const BodySystem* body_ = nullptr;              ///< of the step; null: it sleeps
  std::vector<SymmetricBlocks> diagonal_;         ///< A_ii of each slice's rows
  std::vector<SymmetricBlocks> inverse_;          ///< A_ii^-1, 0 for fixed nodes
  std::vector<SliceVectors> right_;               ///< b + J'lambda, N s
  std::vector<std::array<double, kLanes>> free_;  ///< 1 for a row that is free, else 0
  std::vector<unsigned char> moves_;              ///< some row of the slice is free
  PaddedVectors lower_;                           ///< sum_{j<i} A_ij v_j after the sweep forth, N s
  Deflation deflation_;
  RigidMotions rigid_motions_;
  CoarseMotions coarse_motions_;
  PaddedVectors defect_;       ///< scratch of coarse motions: b + J'lambda - A v, N s
  PaddedVectors along_;        ///< scratch: what they move, m/s
  PaddedVectors along_lower_;  ///< scratch: L times that, N s
  PaddedVectors v_;            ///< scratch: what a sweep works on, m/s
};

}  // namespace tissue_contact
