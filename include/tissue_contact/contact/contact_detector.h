/// @file
/// Room `contact`: instrument shapes against deforming tissue surfaces. Surface positions and link poses in, contacts
/// out.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "tissue_contact/contact/contact.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/mesh/mesh_preparation.h"
#include "tissue_contact/mesh/tissue_surface.h"

namespace tissue_contact {

/// How near a shape is to a tissue's surface.
struct Approach {
  int tissue = -1;  ///< -1: none was near enough
  int instrument = -1;
  int link = -1;                                                ///< index into Instrument::contactLinks()
  int shape = -1;                                               ///< index into ContactLink::shapes
  double distance_m = std::numeric_limits<double>::infinity();  ///< < 0: the surface is inside the shape
  Vector3 p_W = Vector3::Zero();                                ///< the surface's point, m
  Vector3 normal_W = Vector3::Zero();  ///< unit, out of the shape there: moved along it by the distance it just touches
};

/// Where a tissue's surface is nearest to a shape, or deepest in it.
struct NearPlace {
  int tissue = -1;
  int instrument = -1;
  int contact_link = -1;
  int shape = -1;
  Triangle nodes = {0, 0, 0};
  Vector3 weights = Vector3::UnitX();  ///< barycentric
  double distance_m = 0.0;             ///< < 0: in the shape
};

class ContactDetector {
 public:
  /// Mesh shapes are prepared here, which takes some tenths of a second each unless they are in the cache.
  /// @param instruments must outlive the detector.
  /// @param surfaces one per tissue.
  /// @throws std::invalid_argument when a mesh shape has no mesh or no inside.
  ContactDetector(const std::vector<Instrument>& instruments, SharedSurfaces surfaces,
                  const MeshPreparation& preparation = {});
  ~ContactDetector();
  ContactDetector(ContactDetector&&) noexcept;
  ContactDetector& operator=(ContactDetector&&) noexcept;

  /// Every surface feature nearer to a shape than the margin of its tissue, at these positions and poses, sorted by key. Which of them
  /// count as contacts: src/contact/narrow_phase.h. Non-finite positions give no contact. Deterministic: depends on the
  /// arguments alone, not on earlier calls. Not thread-safe (moves the surfaces).
  /// @param positions one per tissue, m, world frame.
  /// @param X_WL per instrument, per link of its model.
  /// @param margins_m one per tissue, >= 0.
  /// @param contacts overwritten; capacity is kept.
  /// @throws std::invalid_argument for sizes that differ from the construction's and a margin not finite or < 0.
  void detect(const std::vector<NodalVectors>& positions, const std::vector<std::vector<Pose>>& X_WL,
              const std::vector<double>& margins_m, std::vector<Contact>& contacts);
  /// The same margin for all.
  void detect(const std::vector<NodalVectors>& positions, const std::vector<std::vector<Pose>>& X_WL, double margin_m,
              std::vector<Contact>& contacts);

  /// For others that detect contacts on them.
  const SharedSurfaces& surfaces() const;

  /// Contacts that the last detect() left out, because two shapes that touch each other press the point from opposed
  /// sides: there is no room for it.
  int pinchedContacts() const;

  /// The surface of a mesh shape as it acts (sampled, edges rounded), in its frame S; null for other shapes.
  /// @param contact_link, shape indices into Instrument::contactLinks() and ContactLink::shapes.
  const TriangleMesh* actingSurface(int instrument, int contact_link, int shape) const;

  /// Brings a contact found earlier up to date: the same material point (key, nodes, weights) against the same shape.
  /// Sets its p_WC, R_WC and gap_m.
  /// @return false when it is no contact any more: farther than `margin_m`, or its surface does not face the shape; and
  ///   for a contact between tissues, which this detector does not know.
  bool measure(const std::vector<NodalVectors>& positions, const std::vector<std::vector<Pose>>& X_WL, double margin_m,
               Contact& contact) const;

  /// Turns the frame of a contact with a shape as the shape's surface turns under its point while that slides in a step, and lets the gap
  /// follow to second order: frame and gap are then those of the step's end, as its forces are (doc/method.md, "Contact frames and landing").
  /// Only where the surface is smooth: all of a turn up to 0.1 rad and of a curvature up to 4 over its smallest half extent, nothing from
  /// twice that on (close to an edge the distance is rounded by no more than the gap); where the gap's gradient is the shape's own normal, and
  /// where the point is not deeper than a tenth of that half extent. Always takes the way along Contact::lean_W out of the gap, which the
  /// way along the normal would add to it.
  /// @param start_X_WL, end_X_WL at both ends of the step.
  /// @param way_W of the tissue's point in the step, as expected, m.
  void turnWithSlide(const std::vector<std::vector<Pose>>& start_X_WL, const std::vector<std::vector<Pose>>& end_X_WL,
                     const Vector3& way_W, Contact& contact) const;

  /// Lowers `closest` to the nearest shape and tissue surface (less half the thickness of a sheet), if any is nearer
  /// than what `closest` holds. Exact, whatever the distance; of a mesh, where a lower bound of it is least. Pairs whose bounding boxes are farther apart than that cost
  /// next to nothing, so keep `closest` from call to call. Sizes as for detect(). Not thread-safe.
  void lowerClosestApproach(const std::vector<NodalVectors>& positions, const std::vector<std::vector<Pose>>& X_WL,
                            Approach& closest);

  /// For every shape and tissue nearer to each other than `within_m` where they are nearest, in order of tissues and shapes.
  /// @param within_m one per tissue; < 0: not looked for on that one.
  void findNear(const std::vector<NodalVectors>& positions, const std::vector<std::vector<Pose>>& X_WL,
                const std::vector<double>& within_m, std::vector<NearPlace>& near);

  /// Goes on with another surface of a tissue, as do all that share it; it is exchanged for the one before.
  void swapSurface(MovingSurface& surface);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// How far a shape reaches from its middle where it is thinnest, m: radius of a sphere, half the smallest edge of a
/// box, min(radius, length / 2) of a cylinder, half the smallest extent of a mesh's bounding box in its own axes (0 for
/// a flat sheet). A step that moves the shape by less cannot carry its middle through a surface.
/// @throws std::invalid_argument for a mesh shape whose mesh was not loaded.
double smallestHalfExtent(const CollisionShape& shape);

}  // namespace tissue_contact
