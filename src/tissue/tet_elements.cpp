#include "tissue/tet_elements.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

std::vector<ElementBatch> makeBatches(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                                      std::vector<ShapeBatch<9>>& shapes) {
  std::vector<ElementBatch> batches((tetrahedra.size() + kLanes - 1) / kLanes);
  ShapeTable<9> table;
  std::vector<std::size_t> places;
  places.reserve(batches.size());
  for (std::size_t b = 0; b < batches.size(); ++b) {
    ShapeBatch<9> shape;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t e = kLanes * b + lane;
      const bool used = e < tetrahedra.size();
      const Tetrahedron& nodes = used ? tetrahedra[e] : tetrahedra.back();
      const Matrix3 edges = edgeMatrix(rest, nodes);
      const Matrix3 rest_inverse = edges.inverse();
      for (std::size_t i = 0; i < 9; ++i) shape[i][lane] = rest_inverse.data()[i];
      batches[b].volume[lane] = used ? edges.determinant() / 6.0 : 0.0;
      batches[b].nodes[lane] = nodes;
    }
    places.push_back(table.add(shape));
  }
  shapes = table.shapes();
  for (std::size_t b = 0; b < batches.size(); ++b) batches[b].rest_inverse = &shapes[places[b]];
  return batches;
}

/// @param lame per element.
std::vector<BatchMaterial> makeBatchMaterials(const std::vector<LameParameters>& lame) {
  std::vector<BatchMaterial> materials((lame.size() + kLanes - 1) / kLanes);
  for (std::size_t slot = 0; slot < materials.size() * kLanes; ++slot) {
    const LameParameters& here = lame[std::min(slot, lame.size() - 1)];
    materials[slot / kLanes].lambda[slot % kLanes] = here.lambda;
    materials[slot / kLanes].mu[slot % kLanes] = here.mu;
  }
  return materials;
}

}  // namespace

TetElements::TetElements(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                         const std::vector<bool>& fixed, const ElementMaterials& materials, const Lame& lameOf,
                         std::shared_ptr<const BlockPattern> couplings)
    : pattern(std::move(couplings)) {
  for (const MaterialDescription& description : materials.materials) checkMaterial(description, "");
  batches = makeBatches(rest, tetrahedra, shapes_);
  std::vector<LameParameters> lame;
  lame.reserve(tetrahedra.size());
  slots_.reserve(tetrahedra.size());
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    lame.push_back(lameOf(materials.of(e)));
    slots_.push_back(findSlots(*pattern, tetrahedra[e], fixed));
    if (!materials.damping_s.empty()) damping_s_.push_back(materials.dampingOf(e));
  }
  damping_s_.shrink_to_fit();
  if (lame.empty()) return;
  material = lame.front();
  const auto is_first = [&](const LameParameters& one) {
    return one.lambda == material.lambda && one.mu == material.mu;
  };
  if (!std::all_of(lame.begin(), lame.end(), is_first)) batch_materials = makeBatchMaterials(lame);
}

TetElement TetElements::element(std::size_t e) const {
  LameParameters lame = material;
  if (!batch_materials.empty()) {
    const BatchMaterial& four = batch_materials[e / kLanes];
    lame = {four.lambda[e % kLanes], four.mu[e % kLanes]};
  }
  return {volume(e), lame, damping_s_.empty() ? 0.0 : damping_s_[e], slots_[e]};
}

void TetElements::split(const std::vector<bool>& still, Held& held) const {
  const auto rests = [&](std::size_t b) {
    bool all = true;
    for (const Tetrahedron& nodes : batches[b].nodes) {
      for (const int node : nodes) all = all && still[node];
    }
    return all;
  };
  splitBatches(batches.size(), rests, held.moving, held.still);
  held.forces.setZero(3, static_cast<Eigen::Index>(still.size()));
}

void carryRanges(StateArchive& archive, std::size_t batches, std::vector<BatchRange>& ranges) {
  archive.carryList(ranges, batches, [&](BatchRange& range) {
    archive.carry(range.begin);
    archive.carry(range.end);
    archive.check(range.begin <= range.end && range.end <= batches, "a range of elements that are not there");
  });
}

void TetElements::Held::carry(StateArchive& archive, std::size_t batches, int nodes) {
  carryRanges(archive, batches, moving);
  carryRanges(archive, batches, still);
  bool any = forces.cols() > 0;
  archive.carry(any);
  archive.check(any || still.empty(), "elements at rest without forces");
  forces.resize(3, any ? nodes : 0);
  archive.carry(forces);
}

void TetElements::prepare(Elasticity::State& state) const {
  state.stiffness = BlockMatrix(pattern);
  if (!damping_s_.empty()) state.damping = BlockMatrix(pattern);
}

Matrix3 TetElements::restInverse(std::size_t element) const {
  const ElementBatch& batch = batches[element / kLanes];
  Matrix3 rest_inverse;
  for (std::size_t i = 0; i < 9; ++i) rest_inverse.data()[i] = (*batch.rest_inverse)[i][element % kLanes];
  return rest_inverse;
}

Eigen::Matrix<double, 3, 4> TetElements::shapeGradients(std::size_t element) const {
  Eigen::Matrix<double, 3, 4> gradients;
  gradients.rightCols<3>() = restInverse(element).transpose();
  gradients.col(0) = -gradients.rightCols<3>().rowwise().sum();
  return gradients;
}

Matrix3 TetElements::deformationGradient(std::size_t element, const NodalVectors& x) const {
  return edgeMatrix(x, batches[element / kLanes].nodes[element % kLanes]) * restInverse(element);
}

}  // namespace tissue_contact
