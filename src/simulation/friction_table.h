/// @file
/// Room `simulation`, private: which friction law holds at a contact. The scene's friction entries in; per contact the
/// law with its axis in the contact plane out.
#pragma once

#include <memory>
#include <vector>

#include "simulation/triangles_of_nodes.h"
#include "tissue_contact/contact/contact.h"
#include "tissue_contact/friction/friction_law.h"
#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// What a contact was like at the end of the step before: for laws that depend on it.
struct ContactBefore {
  double sliding_speed = 0.0;  ///< m/s; of one that was open: how fast the instrument moved over the tissue there
  double pressure = 0.0;       ///< Pa
};

/// Const after construction. What a scene does not use (regions, fibres, anisotropic laws) is neither stored nor looked
/// up.
class FrictionTable {
 public:
  /// @throws std::invalid_argument naming the unknown instrument, link, tissue or region, or the law out of range.
  FrictionTable(const Scene& scene, const std::vector<Instrument>& instruments, const std::vector<Tissue>& tissues);
  ~FrictionTable();
  FrictionTable(FrictionTable&&) noexcept;
  FrictionTable& operator=(FrictionTable&&) noexcept;

  /// @param x deformed positions per tissue, m.
  /// @param X_WL link poses per instrument.
  /// The law's pointers live as long as this table. No allocation.
  CoulombLaw at(const Contact& contact, const std::vector<NodalVectors>& x, const std::vector<std::vector<Pose>>& X_WL,
                const ContactBefore& before) const;

  /// What is needed of the surface of a tissue to find the triangle of a contact; empty without regions and fibres.
  static TrianglesOfNodes trianglesOf(const Tissue& tissue);
  /// Goes on with another surface of a tissue, which has become that one; exchanges its triangles for those before.
  void swapSurface(int index, TrianglesOfNodes& triangles);

  /// Whether any law asks for the pressure.
  bool dependsOnPressure() const;

 private:
  struct Entry;
  struct Surface;
  struct Found {
    const Entry* entry = nullptr;  ///< null: frictionless
    int tissue = -1;               ///< whose regions and fibres the entry refers to
    int triangle = -1;             ///< of its surface, -1 where it has neither
    double axis_sign = 1.0;
  };
  using ByRegion = std::vector<int>;  ///< index into entries_, -1: frictionless; [0]: no region, [1 + r]: region r

  void add(const FrictionDescription& description, const Scene& scene, const std::vector<Instrument>& instruments,
           const std::vector<Tissue>& tissues);
  Found find(const Contact& contact, const std::vector<NodalVectors>& x) const;
  Vector3 axisOf(const Found& found, const Contact& contact, const std::vector<NodalVectors>& x,
                 const std::vector<std::vector<Pose>>& X_WL) const;

  std::vector<Entry> entries_;
  std::vector<std::vector<std::vector<ByRegion>>> by_link_;  ///< [instrument][contact link][tissue]
  std::vector<std::vector<ByRegion>> between_tissues_;       ///< [tissue][other]
  std::vector<Surface> surfaces_;                            ///< per tissue
  std::vector<std::vector<int>> links_;                      ///< [instrument][contact link]: link of its model
};

}  // namespace tissue_contact
