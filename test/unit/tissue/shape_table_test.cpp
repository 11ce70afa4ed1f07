/// Shapes that are kept once: which count as the same, and how few an even block has.
#include "tissue/shape_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tissue/tet_elements.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace shape_table_test {

ShapeBatch<3> numbers(double scale) {
  return {{{scale, -0.3 * scale, 0.0, 1e-9 * scale},
           {0.1 * scale, 0.2 * scale, 0.7 * scale, 0.0},
           {0.0, 0.0, -0.25 * scale, 0.5 * scale}}};
}

TEST(ShapeTable, RoundOffMakesNoOtherShape) {
  ShapeTable<3> table;
  for (const double scale : {137.0, 1e-5, 128.0}) {
    const std::size_t place = table.add(numbers(scale));
    for (const double off : {1e-15, -1e-14, 1e-13}) {
      ShapeBatch<3> shape = numbers(scale);
      for (auto& four : shape) {
        for (double& number : four) number += off * scale;
      }
      EXPECT_EQ(table.add(shape), place) << scale << " off by " << off;
    }
  }
  EXPECT_EQ(table.shapes().size(), 3u);
  EXPECT_EQ(table.shapes().front(), numbers(137.0));
}

TEST(ShapeTable, AnyNumberThatDiffersByMoreMakesOne) {
  ShapeTable<3> table;
  table.add(numbers(137.0));
  std::size_t shapes = 1;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      // By little more than counts as round-off, which the hash does not tell apart, and by so much that it does.
      for (const double off : {1.2e-10, 1e-5}) {
        ShapeBatch<3> shape = numbers(137.0);
        shape[i][lane] += off * 137.0;
        EXPECT_EQ(table.add(shape), shapes) << i << ", " << lane << " off by " << off;
        shapes = table.shapes().size();
      }
    }
  }
  EXPECT_EQ(table.add(numbers(137.0)), 0u);
}

/// How many shapes the batches of a mesh point to.
std::size_t shapesOf(const TetMesh& mesh) {
  const TetElements tets(mesh.positions, mesh.tetrahedra, std::vector<bool>(mesh.positions.cols(), false),
                         MaterialDescription{ElasticModel::kLinear, 5e3, 0.4, 1000.0}, lameParameters);
  std::set<const ShapeBatch<9>*> shapes;
  for (const ElementBatch& batch : tets.batches) shapes.insert(batch.rest_inverse);
  return shapes.size();
}

TEST(ShapeTable, EvenBlocksHaveFewShapesWhereverTheyLie) {
  // 5 tetrahedra a cell, two kinds of cells in turn: batches repeat after four cells, in rows that begin with either kind; where rows are no multiples
  // of four cells, batches lie over their ends too.
  EXPECT_LE(shapesOf(makeBlockMesh({Vector3(0.11, 0.07, 0.03), {10, 10, 5}, {}})), 12u);
  TetMesh mesh = makeBlockMesh({Vector3(0.11, 0.07, 0.03), {24, 12, 6}, {}});
  EXPECT_LE(shapesOf(mesh), 10u);
  const Matrix3 turn = Eigen::AngleAxisd(0.7, Vector3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  mesh.positions = (turn * mesh.positions).colwise() + Vector3(0.4, -1.3, 0.9);
  EXPECT_LE(shapesOf(mesh), 10u);
}

TEST(ShapeTable, EachCellOfAGradedBlockHasItsOwn) {
  BlockDescription block{Vector3(0.11, 0.07, 0.03), {8, 8, 4}, {}};
  for (AxisGrading& grading : block.grading) grading = {1.1, AxisGrading::FineAt::kMinimum};
  const TetMesh mesh = makeBlockMesh(block);
  EXPECT_EQ(shapesOf(mesh), mesh.tetrahedra.size() / kLanes);
}

}  // namespace shape_table_test
}  // namespace tissue_contact
