#!/usr/bin/python3
"""A friction law from a table of measured coefficients over pressure, and a drag that shows what the scene makes of it.

usage: friction_table.py [TABLE.csv], with columns pressure_pa,coefficient. Without: PLA on silicone, the medians of
github.com/tolstoys19/Friction-Measurements-Between-PLA-and-Silicone (MIT, (c) 2024 tolstoys19) that config/pla_on_silicone.yaml has.
"""
import pathlib
import sys

import numpy as np

import tissue_contact as tc

SCENE = "package://tissue_contact/config/pla_on_silicone.yaml"
ABOVE_M, AREA_M2 = 0.001, 0.004 ** 2  # of the plate at joints 0; its face


def main():
    name = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).with_name("pla_on_silicone.csv")
    try:
        table = np.atleast_1d(np.genfromtxt(name, delimiter=",", names=True))
        pressures, coefficients = table["pressure_pa"], table["coefficient"]
    except OSError as error:
        sys.exit("friction_table.py: %s cannot be read: %s" % (name, error))
    except (ValueError, IndexError):
        sys.exit("friction_table.py: %s is no table with the columns pressure_pa,coefficient" % name)
    if not (table.size and np.isfinite([pressures, coefficients]).all()):
        sys.exit("friction_table.py: %s needs rows with a finite number in each cell" % name)
    law = {"friction.0.static": 1.0,  # the factors are the coefficients themselves
           "friction.0.pressures_pa": [0.0, *pressures],  # below the first it is held
           "friction.0.pressure_factors": [coefficients[0], *coefficients],
           "tissues.silicone.material.model": "neo_hookean",
           "solver.iterations": 200}
    simulator = tc.Simulator(tc.load_scene(SCENE, set=law))
    simulator.place("plate", [0.0, 0.0, -ABOVE_M])
    simulator.advance(0.1, {"plate": [0.0, 0.0, -ABOVE_M - 0.00005]})
    print("pressure_pa  measured  simulated")
    for x in np.arange(0.0001, 0.0031, 0.0001):  # 10 mm/s
        simulator.advance(0.01, {"plate": [x, 0.0, -ABOVE_M - 0.00005]})
        force = simulator.wrench("plate", frame="world")
        sliding = simulator.report().static_contacts == 0
        if sliding and force[2] > 0.01:
            pressure = force[2] / AREA_M2
            print("%11.0f %9.2f %10.2f" % (pressure, np.interp(pressure, pressures, coefficients), -force[0] / force[2]))


if __name__ == "__main__":
    main()
