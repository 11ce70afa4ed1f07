/// @file
/// Room `simulation`, private: how far from a surface contacts of the coming step are looked for, and how long a surface's
/// edges are. Tissues and their velocities in; margins out.
#pragma once

#include <utility>
#include <vector>

#include "tissue_contact/contact/contact.h"
#include "tissue_contact/contact/tissue_pair_detector.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// Lengths at rest of the edges of all tissue surfaces, where they are.
class SurfaceEdges {
 public:
  /// Of one surface.
  struct Lengths {
    VectorX at_nodes;      ///< per node, m; 0 for nodes inside
    double mean = 0.0;     ///< of the whole surface, m
    bool graded = false;   ///< some place is more than twice as fine or coarse
    double largest = 0.0;  ///< mean of the surface, or of its coarsest place where it is graded, m
  };
  static Lengths lengthsOf(const Tissue& tissue);

  explicit SurfaceEdges(const std::vector<Tissue>& tissues);

  /// Goes on with another surface of a tissue, whose lengths are exchanged for those before.
  void swapSurface(int index, Lengths& lengths) { std::swap(surfaces_[index], lengths); }

  /// Mean of the sides of the triangles about the contact's point, m; of two surfaces that of the finer one.
  double finer(const Contact& contact) const;

  /// The scale of a surface there, m, of two that of the coarser one: the same mean where the mesh is graded, that of the whole
  /// surface where no place of it is twice as fine or coarse.
  double coarserScale(const Contact& contact) const;
  double largestScale(int tissue) const { return surfaces_[tissue].largest; }

 private:
  double at(int tissue, const std::array<int, 3>& nodes, const Vector3& weights) const;
  double scaleAt(int tissue, const std::array<int, 3>& nodes, const Vector3& weights) const;

  std::vector<Lengths> surfaces_;  ///< per tissue
};

/// Contacts are looked for as far as present speeds can close in the step, and half as much again, since speeds change
/// within it; besides that a hundredth of an edge of the place looked at. What a fast tissue strikes gets its speed within the
/// step and hands it on, so the speed is that of the fastest of the tissues that pairs join, directly or through others.
class DetectionMargins {
 public:
  /// @param edges must outlive this.
  DetectionMargins(const SurfaceEdges& edges, std::size_t tissues, std::vector<TouchingTissues> pairs);

  /// Begins a step. No allocation.
  /// @param v per tissue, m/s. @param instruments_m the longest way of an instrument in the step.
  void begin(const std::vector<NodalVectors>& v, const Vector3& gravity, double dt, double instruments_m);

  /// The widest on each tissue, m; and for each pair of tissues.
  const std::vector<double>& ofTissues() const { return of_tissues_; }
  const std::vector<double>& ofPairs() const { return of_pairs_; }

  /// Where a contact is, m.
  double at(const Contact& contact) const;

 private:
  double alone(int tissue, double edge_m) const;
  double between(int tissue, int other, double edge_m) const;

  const SurfaceEdges& edges_;
  std::vector<TouchingTissues> pairs_;
  double instruments_m_ = 0.0;
  std::vector<std::size_t> group_;  ///< per tissue: one of those that pairs join it to
  std::vector<double> ways_m_;      ///< per tissue: of its fastest node in the step
  std::vector<double> travels_m_;   ///< per tissue: the longest of those in its group
  std::vector<double> of_tissues_;
  std::vector<double> of_pairs_;
};

}  // namespace tissue_contact
