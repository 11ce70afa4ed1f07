/// @file
/// Room `contact`: instrument shapes against deforming tissue surfaces. Surface positions and link poses in, contacts out.
#pragma once

#include <memory>
#include <vector>

#include "tissue_contact/contact/contact.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/instrument.h"

namespace tissue_contact {

/// Surface of one tissue: triangles over its nodes.
struct TissueSurface {
  std::vector<Triangle> triangles;
  std::vector<bool> fixed;  ///< per node; contacts whose weighted nodes are all fixed are dropped: nothing can move
};

class ContactDetector {
 public:
  /// @param instruments must outlive the detector. @param surfaces one per tissue; @param positions one per tissue (m, W).
  ContactDetector(const std::vector<Instrument>& instruments, std::vector<TissueSurface> surfaces,
                  const std::vector<NodalVectors>& positions);
  ~ContactDetector();
  ContactDetector(ContactDetector&&) noexcept;
  ContactDetector& operator=(ContactDetector&&) noexcept;

  /// Every surface feature nearer than `margin_m` to a shape, at these positions and poses, sorted by key.
  /// @param X_WL per instrument, per link of its model. @param contacts overwritten; capacity is kept between calls.
  /// Deterministic; not thread-safe (refits the trees it holds).
  void detect(const std::vector<NodalVectors>& positions, const std::vector<std::vector<Pose>>& X_WL, double margin_m,
              std::vector<Contact>& contacts);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Any right-handed frame with the given unit normal as first column; a continuous function of n except at one point.
Matrix3 contactFrame(const Vector3& n);

}  // namespace tissue_contact
