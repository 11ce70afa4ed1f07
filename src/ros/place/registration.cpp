#include "ros/place/registration.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include "core/rotation_by_svd.h"

namespace tissue_contact {
namespace {

constexpr std::int64_t kLongestGap_ns = 100'000'000;

/// How far the tip must go along a second axis for the rotation about the first to be told, m.
constexpr double kLeastSpread_m = 1e-3;
/// Of that, the residual may be so much: the rotation is then uncertain by some ten degrees in each sample.
constexpr double kMostOfSpread = 0.2;

Pose between(const StampedPose& before, const StampedPose& after, std::int64_t stamp_ns) {
  const double length = static_cast<double>(after.stamp_ns - before.stamp_ns);
  const double share = length > 0.0 ? static_cast<double>(stamp_ns - before.stamp_ns) / length : 0.0;
  Pose X = Pose::Identity();
  X.linear() = Quaternion(before.X.linear()).slerp(share, Quaternion(after.X.linear())).normalized().toRotationMatrix();
  X.translation() = (1.0 - share) * before.X.translation() + share * after.X.translation();
  return X;
}

double angleOf(const Matrix3& R) { return Eigen::AngleAxisd(R).angle(); }

Vector3 spreadOf(const NodalVectors& points) {
  const NodalVectors centred = points.colwise() - points.rowwise().mean().eval();
  const Matrix3 covariance = centred * centred.transpose() / static_cast<double>(points.cols());
  const Vector3 squares = Eigen::SelfAdjointEigenSolver<Matrix3>(covariance).eigenvalues();  // ascending
  return squares.cwiseMax(0.0).cwiseSqrt().reverse();
}

void compareTurns(const std::vector<PosePair>& pairs, Registration& registration) {
  const Matrix3 R_WB = registration.X_WB.linear();
  const auto turn = [&](const PosePair& pair) -> Matrix3 {
    return (R_WB * pair.X_BT.linear()).transpose() * pair.X_WT.linear();
  };
  Matrix3 sum = Matrix3::Zero();
  for (const PosePair& pair : pairs) sum += turn(pair);
  const Matrix3 mean = rotationBySvd(sum);
  registration.tip_turn_rad = angleOf(mean);
  double squares = 0.0;
  for (const PosePair& pair : pairs) squares += std::pow(angleOf(mean.transpose() * turn(pair)), 2);
  registration.turn_rms_rad = std::sqrt(squares / static_cast<double>(pairs.size()));
}

}  // namespace

std::vector<PosePair> pairPoses(const std::vector<StampedPose>& tips, const std::vector<StampedPose>& measured) {
  std::vector<PosePair> pairs;
  for (const StampedPose& tip : tips) {
    const auto after = std::lower_bound(measured.begin(), measured.end(), tip.stamp_ns,
                                        [](const StampedPose& pose, std::int64_t ns) { return pose.stamp_ns < ns; });
    if (after == measured.end()) continue;
    const auto before = after->stamp_ns == tip.stamp_ns || after == measured.begin() ? after : std::prev(after);
    if (before->stamp_ns > tip.stamp_ns || after->stamp_ns - before->stamp_ns > kLongestGap_ns) continue;
    pairs.push_back({tip.X, between(*before, *after, tip.stamp_ns)});
  }
  return pairs;
}

Registration registerBase(const std::vector<PosePair>& pairs) {
  NodalVectors from(3, static_cast<Eigen::Index>(pairs.size()));
  NodalVectors to(3, from.cols());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = pairs[i].X_BT.translation();
    to.col(static_cast<Eigen::Index>(i)) = pairs[i].X_WT.translation();
  }
  Registration registration;
  registration.X_WB.matrix() = Eigen::umeyama(from, to, false);
  registration.spread_m = spreadOf(from);
  const VectorX distances = (registration.X_WB * from - to).colwise().norm();
  registration.rms_m = std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size()));
  registration.largest_m = distances.maxCoeff();
  compareTurns(pairs, registration);
  return registration;
}

void requireTrustworthy(const Registration& registration) {
  const Vector3& spread = registration.spread_m;
  std::ostringstream text;
  text.precision(3);
  if (!(spread[1] >= kLeastSpread_m)) {
    text << "the motion cannot tell the base: the tip goes " << 1e3 * spread[0] << " mm (RMS) along one axis, but only "
         << 1e3 * spread[1] << " mm across it, so that the rotation about that axis is free; at least "
         << 1e3 * kLeastSpread_m << " mm are needed: record a motion that fills a volume";
    throw std::runtime_error(text.str());
  }
  if (registration.rms_m <= kMostOfSpread * spread[1]) return;
  text << "no base fits: the residual is " << 1e3 * registration.rms_m << " mm RMS, where the tip goes "
       << 1e3 * spread[0] << " x " << 1e3 * spread[1] << " x " << 1e3 * spread[2]
       << " mm (RMS). Look at joint_names (is each recorded joint the URDF's?), units (rad and m), tip_link (is it the "
          "frame "
          "that was measured?), and whether arm and topic belong together";
  throw std::runtime_error(text.str());
}

}  // namespace tissue_contact
