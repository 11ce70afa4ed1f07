#include "tissue_contact/simulation/law_error.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "tissue_contact/simulation/simulator.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

double equivalentStrain(const Matrix3& F) {
  const Matrix3 C = F.transpose() * F;
  const double mean = (C(0, 0) + C(1, 1) + C(2, 2)) / 3.0;
  const Vector3 d(C(0, 0) - mean, C(1, 1) - mean, C(2, 2) - mean);
  const Vector3 s(C(1, 0), C(2, 1), C(2, 0));
  return std::sqrt((d.squaredNorm() + 2.0 * s.squaredNorm()) / 6.0);
}

double likelyLawError(ElasticModel model, double poissons_ratio, double strain) {
  if (!hasRange(model)) return 0.0;
  const double more = std::clamp(poissons_ratio, 0.3, 0.49) - 0.3;
  if (model == ElasticModel::kCorotational) {
    const double s = std::min(strain, 0.4);
    return s * (-0.26 - 1.23 * more - 0.44 * s);
  }
  const double s = std::min(strain, 0.6);
  return s * (0.22 - 0.87 * more - 0.69 * s);
}

bool LawAlarm::leaves(double relative) {
  const double size = std::abs(relative);
  return !std::exchange(outside_, size > (outside_ ? kBack : kLeft)) && outside_;
}

std::string lawErrorText(const Simulator& simulator) {
  const LawError& error = simulator.report().law_error;
  const std::string by =
      error.instrument < 0 ? "another tissue" : "'" + simulator.instruments()[error.instrument].name() + "'";
  const TissueDescription& tissue = simulator.scene().tissues[error.tissue];
  std::ostringstream text;
  text.precision(2);
  text << "tissue '" << tissue.name << "' is strained by " << error.strain << " under " << by
       << ", beyond the range of the " << elasticModelName(tissue.material.model) << " law: forces are likely "
       << 100.0 * std::abs(error.relative) << " % " << (error.relative < 0.0 ? "too small" : "too large")
       << " against neo-Hookean tissue that averages its change of volume. For such depths set material: {model: "
          "neo_hookean, "
       << "dilatation: patch}; under sharp edges in coarse cells without the latter";
  return text.str();
}

}  // namespace tissue_contact
