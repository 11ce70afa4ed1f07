/// What is averaged over patches where the scene leaves it to `auto`, and what it may ask for.
#include "tissue_contact/tissue/make_elasticity.h"

#include <gtest/gtest.h>

#include <ostream>

namespace tissue_contact {
namespace make_elasticity_test {

struct Case {
  double poissons_ratio;
  ElasticModel model;
  Dilatation dilatation;
  Distortion distortion;
  bool averages_dilatation;
  bool averages_distortion;
};

constexpr auto kLinear = ElasticModel::kLinear;
constexpr auto kNeoHookean = ElasticModel::kNeoHookean;

constexpr Case kCases[] = {
    {0.45, kLinear, Dilatation::kAuto, Distortion::kAuto, true, true},
    {0.2, kLinear, Dilatation::kAuto, Distortion::kAuto, false, false},
    {0.2, kLinear, Dilatation::kAuto, Distortion::kPatch, true, true},
    {0.45, kLinear, Dilatation::kAuto, Distortion::kElement, true, false},
    {0.45, kLinear, Dilatation::kElement, Distortion::kAuto, false, false},
    {0.2, ElasticModel::kCorotational, Dilatation::kPatch, Distortion::kAuto, true, true},
    // Neo-Hookean tissue averages a part of all strain; of the change of volume all only where asked to.
    {0.45, kNeoHookean, Dilatation::kAuto, Distortion::kAuto, false, true},
    {0.2, kNeoHookean, Dilatation::kAuto, Distortion::kAuto, false, false},
    {0.2, kNeoHookean, Dilatation::kAuto, Distortion::kPatch, false, true},
    {0.45, kNeoHookean, Dilatation::kPatch, Distortion::kAuto, true, true},
    {0.45, kNeoHookean, Dilatation::kPatch, Distortion::kElement, true, false},
    {0.45, kNeoHookean, Dilatation::kElement, Distortion::kAuto, false, false},
    {0.45, kNeoHookean, Dilatation::kAuto, Distortion::kElement, false, false},
    {0.45, ElasticModel::kMassSpring, Dilatation::kAuto, Distortion::kAuto, false, false},
};

void PrintTo(const Case& one, std::ostream* out) {
  *out << elasticModelName(one.model) << " " << one.poissons_ratio << " dilatation " << static_cast<int>(one.dilatation)
       << " distortion " << static_cast<int>(one.distortion);
}

class Averages : public testing::TestWithParam<Case> {};

TEST_P(Averages, AreWhatIsAskedForOrFits) {
  MaterialDescription material{GetParam().model, 5e3, GetParam().poissons_ratio, 1000.0};
  material.dilatation = GetParam().dilatation;
  material.distortion = GetParam().distortion;
  EXPECT_EQ(averagesDilatation(material), GetParam().averages_dilatation);
  EXPECT_EQ(averagesDistortion(material), GetParam().averages_distortion);
  material.prony_series = {{0.5, 0.1}};  // its stress is that of elements
  EXPECT_EQ(averagesDilatation(material), GetParam().averages_dilatation);
  EXPECT_FALSE(averagesDistortion(material));
}

TEST(AveragesOfRefined, NeoHookeanTissueIsAveragedToo) {
  TissueDescription tissue;
  tissue.material = {kNeoHookean, 5e3, 0.45, 1000.0};
  EXPECT_FALSE(averagesDilatation(materialsOf(tissue)));
  tissue.refinement.mode = RefinementDescription::Mode::kGiven;
  EXPECT_TRUE(averagesDilatation(materialsOf(tissue)));
  EXPECT_TRUE(averagesDistortion(materialsOf(tissue)));
  tissue.material.poissons_ratio = 0.2;
  EXPECT_FALSE(averagesDilatation(materialsOf(tissue)));
  tissue.material.distortion = Distortion::kPatch;
  EXPECT_TRUE(averagesDilatation(materialsOf(tissue)));
  tissue.material = {kNeoHookean, 5e3, 0.45, 1000.0};
  tissue.material.dilatation = Dilatation::kElement;
  EXPECT_FALSE(averagesDilatation(materialsOf(tissue)));
}

INSTANTIATE_TEST_SUITE_P(, Averages, testing::ValuesIn(kCases));

}  // namespace make_elasticity_test
}  // namespace tissue_contact
