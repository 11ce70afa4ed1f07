/// @file
/// Room `simulation`, private: what the tissues and instruments of a scene may take together. Sizes in as soon as they
/// are known, before anything is built from them; an EntryError with the figures and the fix out.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/tissue/tissue_description.h"

namespace tissue_contact {

class SceneBudget {
 public:
  /// Estimate for all tissues, bytes: what a common workstation can spare.
  static constexpr std::size_t kMostBytes = std::size_t{4} << 30U;
  /// Estimate for the factors of all tissues, bytes; the time to compute them grows with the square of it, and is some
  /// minutes here.
  static constexpr std::size_t kMostFactorBytes = std::size_t{2} << 30U;
  /// Shapes that are meshes: each holds a grid of 4 MB.
  static constexpr std::size_t kMostMeshShapes = 200;

  explicit SceneBudget(const Scene& scene) : scene_(scene) {}

  /// Adds every tissue whose size the scene itself tells: blocks and sheets.
  /// @throws EntryError "tissues[i]".
  void addGenerated();
  /// Adds a tissue; one that is refined with as many nodes as it may come to have.
  /// @throws EntryError, without the tissue's own entry, when the scene becomes too large by it.
  void add(const TissueDescription& tissue, std::size_t nodes, std::size_t elements);
  /// Adds an instrument's shapes.
  /// @throws EntryError, without the instrument's own entry.
  void add(const Instrument& instrument);

  std::size_t factorBytes() const { return factor_bytes_; }

 private:
  const Scene& scene_;
  std::size_t elements_ = 0;
  std::size_t bytes_ = 0;
  std::size_t factor_bytes_ = 0;
  std::size_t shapes_ = 0;
  std::size_t mesh_shapes_ = 0;
  std::size_t shape_triangles_ = 0;
};

/// "120000 tetrahedra, 25000 nodes, about 230 MB".
std::string sizeText(const TissueDescription& tissue, std::size_t nodes, std::size_t elements);

/// Tells how far the building of large tissues has come; says nothing while all are small. By size, not by time: what a
/// stage will take is not known before it is over.
class BuildProgress {
 public:
  explicit BuildProgress(std::function<void(const std::string&)> say) : say_(std::move(say)) {}

  /// A tissue is about to be built.
  /// @param ordinal "1 of 2".
  void beginTissue(const TissueDescription& tissue, const std::string& ordinal, std::size_t nodes,
                   std::size_t elements);
  /// Something else about all tissues is about to be done.
  void stage(const std::string& line) const;

 private:
  /// Elements that take about a second on a busy machine.
  static constexpr std::size_t kWorthALine = 100'000;

  std::function<void(const std::string&)> say_;
  std::size_t unsaid_ = 0;
  std::size_t all_ = 0;
};

}  // namespace tissue_contact
