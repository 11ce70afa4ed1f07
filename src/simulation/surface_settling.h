/// @file
/// Room `simulation`, private: a surface whose cells have grown under instruments leaves what its new triangles cut into over
/// some steps. Contacts before and after the mesh has changed in; the depth that may stay in this step out.
#pragma once

#include <cstddef>
#include <vector>

#include "simulation/detection_margins.h"
#include "tissue_contact/contact/contact.h"
#include "tissue_contact/core/state_archive.h"
#include "tissue_contact/simulation/solved_contact.h"

namespace tissue_contact {

/// Larger triangles cut into what smaller ones fitted; pushed out within a step they met it with 1.7 times its force
/// (doc/notes/accuracy.md, "Cells that grow under a tool").
class SurfaceSettling {
 public:
  /// @param edges must outlive this.
  SurfaceSettling(std::size_t tissues, const SurfaceEdges& edges);

  void clear();  ///< nothing settles

  /// The mesh of a tissue is about to change: notes how fine it is under instruments.
  void noteCells(int tissue, const std::vector<SolvedContact>& contacts);
  /// Begins a step with the contacts that were found: where cells have grown since noteCells() the surface begins to settle.
  void begin(const std::vector<Contact>& found);
  /// How deep a contact may be at the end of this step, m. Between tissues nothing settles: a gap there may be what squeezes a sheet.
  double depth(const ContactKey& key) const { return key.instrument < 0 ? 0.0 : surfaces_[key.tissue].depth_m; }
  /// A step of `dt` is taken.
  void advance(double dt);

  void carry(StateArchive& archive);  ///< on reading, refuses what is no depth

 private:
  struct Surface {
    double cell_m = 0.0;   ///< finest edge under instruments before the mesh changed in this step; 0: it has not
    double depth_m = 0.0;  ///< that is left
    double speed_m_per_s = 0.0;
  };

  const SurfaceEdges& edges_;
  std::vector<Surface> surfaces_;  ///< per tissue
};

}  // namespace tissue_contact
