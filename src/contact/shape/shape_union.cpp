#include "contact/shape/shape_union.h"

#include <algorithm>
#include <cmath>

namespace tissue_contact {
namespace {

/// Coefficients (s, t) with p = s a + t b + something square to both, for unit a and b that are not parallel.
Vector2 coefficients(const Vector3& a, const Vector3& b, const Vector3& p) {
  const double cosine = a.dot(b);
  const double along_a = a.dot(p);
  const double along_b = b.dot(p);
  return Vector2(along_a - cosine * along_b, along_b - cosine * along_a) / (1.0 - cosine * cosine);
}

/// Normals nearer to parallel than this (sine squared) do not say where two shapes meet.
constexpr double kParallelSineSquared = 1e-6;

/// Whether a ball around the point where the shapes are that far away touches both, to a hundredth of its radius.
bool isPlaced(const SignedDistance& a, const SignedDistance& b, double radius) {
  return std::max(std::abs(a.distance - radius), std::abs(b.distance - radius)) < 0.01 * radius;
}

/// Least sum of both distances found on the way into the groove, down the sum's gradient from a point that is so far away from them: what is left
/// between the shapes where it closes. Where they cross the sum falls evenly, and a step of Newton's method ends there; where they only touch
/// it is square to the way, and a step of twice that length does, or else the one to the lowest point of the parabola through all three. Not farther
/// than twice the radius: jaws that stand apart do meet at their pivot. The sum is never less than the gap, so what is not found stays open.
double leastRoom(const PlacedShape& first, const PlacedShape& second, const Vector3& p_W,
                 const SignedDistance& at_first, const SignedDistance& at_second, double radius_m, double enough) {
  constexpr int kSteps = 2;
  constexpr double kFarthest = 2.0 * (1.0 + 1e-6);  // radii, and round-off of the two of a limited step
  Vector3 at = p_W;
  Vector3 gradient = at_first.normal + at_second.normal;
  double least = at_first.distance + at_second.distance;
  for (int k = 0; k < kSteps && least > enough; ++k) {
    const Vector3 from = at;
    const double steepness = gradient.norm();
    if (!(steepness > 0.0)) break;
    const Vector3 step = -std::min(least / steepness, radius_m) / steepness * gradient;
    const auto look = [&](double steps) {
      const Vector3 there = from + steps * step;
      const SignedDistance a = distanceAt(first, there);
      const SignedDistance b = distanceAt(second, there);
      if (a.distance + b.distance < least && (there - p_W).norm() <= kFarthest * radius_m) {
        least = a.distance + b.distance;
        at = there;
        gradient = a.normal + b.normal;
      }
      return a.distance + b.distance;
    };
    const double before = least, once = look(1.0), twice = look(2.0);
    const double bend = before - 2.0 * once + twice;
    if (bend > 0.0) look(std::clamp(0.5 * (3.0 * before - 4.0 * once + twice) / bend, 0.0, 2.0));
    if (at == from) break;
  }
  return least;
}

}  // namespace

SignedDistance distanceAt(const PlacedShape& shape, const Vector3& p_W) {
  const Matrix3& R_WS = shape.X_WS.linear();
  SignedDistance here = shape.distance->at(R_WS.transpose() * (p_W - shape.X_WS.translation()));
  here.normal = R_WS * here.normal;
  return here;
}

bool areOpposed(const SignedDistance& first, const SignedDistance& second) {
  constexpr double kOpposed = -0.9;  // cosine: 26 degrees from each other's opposite
  return first.normal.dot(second.normal) < kOpposed;
}

bool fillGroove(const PlacedShape& first, const PlacedShape& second, const Vector3& p_W, double radius_m, double room_m,
                const SignedDistance& at_first, const SignedDistance& at_second, SignedDistance& filled) {
  constexpr double kOpen = 4.0;        // times `room_m`: nothing is filled
  constexpr int kSteps = 8;            // of Newton's method, none longer than the radius
  constexpr double kFarthest = 4.0;    // radii: a ball that far away has slipped out of the groove
  constexpr double kNearCentre = 0.1;  // of the radius: no direction there, and nothing near to touch
  SignedDistance a = at_first;
  SignedDistance b = at_second;
  const double closes_after = std::max(0.0, a.distance + b.distance) / (a.normal + b.normal).norm();
  double radius = radius_m * std::clamp(2.0 - closes_after / radius_m, 0.0, 1.0);
  if (!(radius > 0.0) || !(a.distance < radius && b.distance < radius)) return false;
  radius *=
      std::clamp((kOpen - leastRoom(first, second, p_W, a, b, radius_m, room_m) / room_m) / (kOpen - 1.0), 0.0, 1.0);
  if (!(radius > 0.0) || !(a.distance < radius && b.distance < radius)) return false;
  Vector3 centre = p_W;
  for (int k = 0; k < kSteps; ++k) {
    const double cosine = a.normal.dot(b.normal);
    if (!(1.0 - cosine * cosine > kParallelSineSquared)) return false;
    const double short_a = radius - a.distance;
    const double short_b = radius - b.distance;
    const Vector3 step =
        ((short_a - cosine * short_b) * a.normal + (short_b - cosine * short_a) * b.normal) / (1.0 - cosine * cosine);
    centre += step * std::min(1.0, radius / step.norm());
    if (!((centre - p_W).norm() < kFarthest * radius_m)) return false;
    a = distanceAt(first, centre);
    b = distanceAt(second, centre);
    if (isPlaced(a, b, radius)) break;
  }
  const double cosine = a.normal.dot(b.normal);
  if (!isPlaced(a, b, radius) || !(1.0 - cosine * cosine > kParallelSineSquared)) return false;
  // The groove lies between the points that the ball touches.
  if (!(coefficients(a.normal, b.normal, centre - p_W).minCoeff() > 0.0)) return false;
  const double to_centre = (centre - p_W).norm();
  if (!(to_centre > kNearCentre * radius) || !(radius - to_centre < at_first.distance)) return false;
  filled = {radius - to_centre, (centre - p_W) / to_centre};
  return true;
}

}  // namespace tissue_contact
