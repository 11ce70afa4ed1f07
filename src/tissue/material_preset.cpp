#include "tissue_contact/tissue/material_preset.h"

#include <stdexcept>

#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {

// Sources give shear moduli G or stresses; E = 3 G for what keeps its volume. Poisson's ratio: they take these materials for
// incompressible; 0.45 is what tetrahedra follow without locking, 0.49 presses some 5 % harder.
const std::vector<MaterialPreset>& materialPresets() {
  static const std::vector<MaterialPreset> all = {
      {"liver", 5400, 4200, 6600, 0.45, 1060, 0.003, "G = 1.8 +- 0.4 kPa, quasistatic; E = 3 G",
       "Phys. Med. Biol. 64 (2019) 225001, table 1; doi:10.1088/1361-6560/ab5010"},
      {"liver_tumour", 70200, 59400, 70200, 0.45, 1060, 0.003,
       "G = 23.4 kPa (hepatocellular carcinoma), 19.8 kPa (diseased liver); E = 3 G",
       "Phys. Med. Biol. 64 (2019) 225001, table 1; doi:10.1088/1361-6560/ab5010"},
      {"gallbladder_wall", 255000, 230400, 279600, 0.45, 1060, 0.003, "G = 85 +- 8.2 kPa; E = 3 G",
       "Phys. Med. Biol. 64 (2019) 225001, table 1; doi:10.1088/1361-6560/ab5010"},
      {"kidney", 14700, 13200, 30600, 0.45, 1050, 0.003,
       "healthy volunteers, G = 4.9 +- 0.5 kPa at 45 Hz (the value), 9.4 +- 0.8 kPa at 76 Hz; E = 3 G",
       "J. Magn. Reson. Imaging 34 (2011) 880-886, doi:10.1002/jmri.22670; density: Woodard and White, "
       "Br. J. Radiol. 59 (1986) 1209-1218"},
      {"spleen", 10700, 7060, 16700, 0.45, 1060, 0.003,
       "healthy volunteers, G = 3.565 kPa at 60 Hz, from 2.353 to 5.581 kPa; E = 3 G",
       "Mannelli and others, Am. J. Roentgenol. 195 (2010) 387-392, doi:10.2214/AJR.09.3390; density: Woodard and "
       "White, Br. J. Radiol. 59 (1986) 1209-1218"},
      {"gelatine", 12500, 6000, 30700, 0.45, 1000, 0.0003,
       "5 % gelatine in water, G = 4.18 +- 0.84 kPa; 3 % 2.01, 7 % 10.24 kPa; E = 3 G; damping: its viscosity over G, "
       "0.6 Pa s over 2.01 kPa; density: of water",
       "Nguyen and others, Ultrasound Med. Biol. 40 (2014) 168-176"},
      {"plastisol", 20000, 6000, 45000, 0.45, 1000, 0.003,
       "soft PVC by the share of softener, E = 6 to 45 kPa between 0 and 15 % strain; the value: our choice between",
       "Li, Belmont and Shih, Procedia Manufacturing 1 (2015) 866-878; density 1000 +- 40: Phys. Med. Biol. 50 (2005) "
       "N141-N153"},
      {"dragonskin_10", 260000, 260000, 260000, 0.45, 1070, 0.003,
       "tension of 22 psi (152 kPa) at 100 % strain; E = 3 G of a neo-Hookean body, 1.71 times that",
       "Smooth-On, Dragon Skin Series, technical bulletin"},
      {"dragonskin_20", 579000, 579000, 579000, 0.45, 1080, 0.003,
       "tension of 49 psi (338 kPa) at 100 % strain; E as for dragonskin_10",
       "Smooth-On, Dragon Skin Series, technical bulletin"},
      {"dragonskin_30", 1017000, 1017000, 1017000, 0.45, 1080, 0.003,
       "tension of 86 psi (593 kPa) at 100 % strain; E as for dragonskin_10",
       "Smooth-On, Dragon Skin Series, technical bulletin"},
  };
  return all;
}

const MaterialPreset& materialPreset(const std::string& name) {
  std::vector<std::string> names;
  for (const MaterialPreset& preset : materialPresets()) {
    if (preset.name == name) return preset;
    names.emplace_back(preset.name);
  }
  throw std::invalid_argument("is " + inQuotes(name) + ", which is no material known by name; " +
                              suggestion(name, names) + "there are: " + joined(names) +
                              "; or give a map with youngs_modulus_pa, poissons_ratio and density_kg_per_m3");
}

}  // namespace tissue_contact
