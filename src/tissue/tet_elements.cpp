#include "tissue/tet_elements.h"

#include <Eigen/LU>
#include <utility>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

std::vector<ElementBatch> makeBatches(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                                      const std::vector<TetElement>& elements) {
  std::vector<ElementBatch> batches((elements.size() + kLanes - 1) / kLanes);
  for (std::size_t slot = 0; slot < batches.size() * kLanes; ++slot) {
    const bool used = slot < elements.size();
    const Tetrahedron& nodes = used ? tetrahedra[slot] : tetrahedra.back();
    ElementBatch& batch = batches[slot / kLanes];
    const std::size_t lane = slot % kLanes;
    const Matrix3 rest_inverse = edgeMatrix(rest, nodes).inverse();
    for (std::size_t i = 0; i < 9; ++i) batch.rest_inverse[i][lane] = rest_inverse.data()[i];
    batch.volume[lane] = used ? elements[slot].volume : 0.0;
    batch.nodes[lane] = nodes;
  }
  return batches;
}

std::vector<BatchMaterial> makeBatchMaterials(const std::vector<TetElement>& elements) {
  std::vector<BatchMaterial> materials((elements.size() + kLanes - 1) / kLanes);
  for (std::size_t slot = 0; slot < materials.size() * kLanes; ++slot) {
    const LameParameters& lame = slot < elements.size() ? elements[slot].lame : elements.back().lame;
    materials[slot / kLanes].lambda[slot % kLanes] = lame.lambda;
    materials[slot / kLanes].mu[slot % kLanes] = lame.mu;
  }
  return materials;
}

}  // namespace

TetElements::TetElements(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                         const std::vector<bool>& fixed, const ElementMaterials& materials, const Lame& lame,
                         std::shared_ptr<const BlockPattern> couplings)
    : damps(!materials.damping_s.empty()), pattern(std::move(couplings)) {
  for (const MaterialDescription& description : materials.materials) checkMaterial(description, "");
  elements.reserve(tetrahedra.size());
  bool same = true;
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    elements.push_back({edgeMatrix(rest, tetrahedra[e]).determinant() / 6.0, lame(materials.of(e)),
                        materials.dampingOf(e), findSlots(*pattern, tetrahedra[e], fixed)});
    const LameParameters& first = elements.front().lame;
    same = same && elements.back().lame.lambda == first.lambda && elements.back().lame.mu == first.mu;
  }
  batches = makeBatches(rest, tetrahedra, elements);
  material =
      elements.empty() ? LameParameters{} : LameParameters{elements.front().lame.lambda, elements.front().lame.mu};
  if (!same) batch_materials = makeBatchMaterials(elements);
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
  if (damps) state.damping = BlockMatrix(pattern);
}

Matrix3 TetElements::restInverse(std::size_t element) const {
  const ElementBatch& batch = batches[element / kLanes];
  Matrix3 rest_inverse;
  for (std::size_t i = 0; i < 9; ++i) rest_inverse.data()[i] = batch.rest_inverse[i][element % kLanes];
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
