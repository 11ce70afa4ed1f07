#include "contact/least_width.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace tissue_contact {

double leastWidth(const MovingSurface& surface) {
  NodalVectors x(3, static_cast<Eigen::Index>(surface.nodes().size()));
  if (x.cols() == 0) return 0.0;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    x.col(i) = surface.rest().col(surface.nodes()[static_cast<std::size_t>(i)]);
  const Vector3 middle = x.rowwise().mean();
  x.colwise() -= middle;
  const Matrix3 spread = x * x.transpose();
  const Matrix3 axes = Eigen::SelfAdjointEigenSolver<Matrix3>(spread).eigenvectors();
  const NodalVectors along = axes.transpose() * x;
  const double width = (along.rowwise().maxCoeff() - along.rowwise().minCoeff()).minCoeff();
  return std::min(width, surface.smallestExtent());
}

}  // namespace tissue_contact
