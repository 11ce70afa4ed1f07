/// The example of friction over pressure: the scene's table is what its source says, and what its contacts slide with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "support/text_scene.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/friction/friction_law.h"

namespace tissue_contact {
namespace {

std::string sceneText() {
  return readFile(TISSUE_CONTACT_SOURCE_DIR "/config/pla_on_silicone.yaml", "scene", std::uintmax_t{1} << 20U);
}

/// Fields may be in quotes and then hold commas and ends of lines.
std::vector<std::vector<std::string>> parseCsv(const std::string& text) {
  std::vector<std::vector<std::string>> rows(1, std::vector<std::string>(1));
  bool quoted = false;
  for (const char c : text) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      rows.back().emplace_back();
    } else if (c == '\n' && !quoted) {
      rows.emplace_back(1);
    } else {
      rows.back().back() += c;
    }
  }
  return rows;
}

std::size_t columnOf(const std::vector<std::string>& head, const char* name) {
  return std::find(head.begin(), head.end(), name) - head.begin();
}

/// Coefficients at each pressure, Pa, of one apparatus and material.
std::map<long, std::vector<double>> measured(const std::string& file) {
  const auto rows = parseCsv(readFile(file, "measurements", std::uintmax_t{1} << 24U));
  const std::size_t series = columnOf(rows[0], "DataName");
  const std::size_t pressure = columnOf(rows[0], "H.pressure");
  const std::size_t friction = columnOf(rows[0], "CoF.mean");
  std::map<long, std::vector<double>> all;
  for (const std::vector<std::string>& row : rows) {
    if (row.size() != rows[0].size() || row[series] != "Nanotribometer DragonSkin10") continue;
    all[std::lround(1000.0 * std::strtod(row[pressure].c_str(), nullptr))].push_back(
        std::strtod(row[friction].c_str(), nullptr));
  }
  return all;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

TEST(PlaOnSilicone, TableHoldsTheMediansOfTheMeasurements) {
  const std::string file = TISSUE_CONTACT_SHARED_DATA "/pla_on_silicone_friction.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
  const Scene scene = parseScene(sceneText(), "scene", [](const std::string&) { return packageDirectory(); });
  const FrictionLawDescription& law = scene.friction.at(0).law;
  const auto all = measured(file);
  ASSERT_EQ(law.pressures_pa.size(), 9u);
  EXPECT_EQ(law.static_coefficients[0], 1.0);
  EXPECT_EQ(law.kinetic_coefficients[0], 1.0);
  EXPECT_EQ(law.pressure_factors[0], law.pressure_factors[1]) << "held below what was measured";
  for (std::size_t i = 1; i < law.pressures_pa.size(); ++i) {
    const long pressure = std::lround(law.pressures_pa[i]);
    ASSERT_EQ(all.count(pressure), 1u) << pressure << " Pa";
    EXPECT_NEAR(law.pressure_factors[i], median(all.at(pressure)), 0.005 + 1e-12) << pressure << " Pa";
  }
}

/// Mean coefficient of what slides, by its forces, weighted by the normal ones; and by the table at the mean pressure under
/// the plate.
struct Sliding {
  double by_forces = 0.0;
  double pressure = 0.0;
};

Sliding slide(double depth_m) {
  Simulator simulator = makeSimulator(sceneText());
  for (int k = 1; k <= 100; ++k) simulator.advance(0.001, {Vector3(0.0, 0.0, -0.001 - depth_m * k / 100.0)});
  for (int k = 1; k <= 200; ++k) simulator.advance(0.001, {Vector3(1e-5 * k, 0.0, -0.001 - depth_m)});
  double normal = 0.0;
  double tangential = 0.0;
  for (const SolvedContact& solved : simulator.contacts()) {
    const Vector3 f = solved.contact.R_WC.transpose() * solved.force_on_tissue_n;
    normal += f.x();
    tangential += f.tail<2>().norm();
  }
  EXPECT_EQ(simulator.report().static_contacts, 0) << "all slides";
  return {tangential / normal, normal / (0.004 * 0.004)};
}

TEST(PlaOnSilicone, SlidesTheLessRoughTheHarderItIsPressed) {
  const Sliding light = slide(0.00005);
  const Sliding hard = slide(0.0004);
  RecordProperty("light_pa", std::to_string(light.pressure));
  RecordProperty("hard_pa", std::to_string(hard.pressure));
  printf("light %g Pa mu %g, hard %g Pa mu %g\n", light.pressure, light.by_forces, hard.pressure, hard.by_forces);
  EXPECT_LT(hard.by_forces, light.by_forces);
}

}  // namespace
}  // namespace tissue_contact
