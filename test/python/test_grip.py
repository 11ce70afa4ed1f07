"""Static friction holds what the jaws of a real arm carry."""
import os
import pathlib

import numpy as np
import pytest

import tissue_contact as tc

MODEL = pathlib.Path(os.environ.get("TISSUE_CONTACT_SHARED_DATA", "")) / "dvrk_psm/psm2_caudier.urdf"
PLATE = """<robot name='plate'><link name='plate'><collision><geometry><box size='0.1 0.1 0.02'/></geometry></collision></link></robot>"""
MASS_KG = 0.019
SIZE_M = (0.004, 0.006, 0.010)
INSERTED_M = 0.15
JAW_M = 0.0175  # from the jaws' axis to the middle of what they hold

SCENE = """
gravity_m_per_s2: [0, 0, -9.81]
tissues:
  - name: stone
    block: {{size_m: {size}, cells: [4, 6, 10]}}
    refinement: never
    material: {{youngs_modulus_pa: 1.0e5, poissons_ratio: 0.45, density_kg_per_m3: {density}}}
    damping: {{stiffness_s: 0.003}}
instruments:
  - name: psm
    urdf: {model}
    base_pose: {{position_m: [-0.25, 0, -0.3325]}}
    joint_state_topics: [/psm/js]
    tip_link: PSM2_tool_wrist_caudier_ee_link
    contact_links: [PSM2_tool_wrist_caudier_link_2_left, PSM2_tool_wrist_caudier_link_2_right]
  - {{name: plate, urdf: {plate}, base_pose: {{position_m: [0, 0, -0.01]}}, tip_link: plate, contact_links: [plate]}}
friction:
  - {{instrument: psm, tissue: stone, static: 0.6, kinetic: 0.4}}
  - {{instrument: plate, tissue: stone, static: 0.6, kinetic: 0.4}}
"""


def joints(half_angle_rad, up_m=0.0):
    return {"psm": [0.0, 0.0, INSERTED_M - up_m, 0.0, 0.0, 0.0, 2.0 * half_angle_rad]}


@pytest.mark.skipif(not MODEL.is_file(), reason="no shared data with the model of a PSM")
def test_jaws_hold_what_kinetic_friction_would_not(tmp_path):
    """1.6 times the weight, but kinetic friction holds .97 times. 20 g are held in some steps and tolerances, 20.5 g by none, not solved to 1e-6 either."""
    plate = tmp_path / "plate.urdf"
    plate.write_text(PLATE)
    density = MASS_KG / np.prod(SIZE_M)
    simulator = tc.Simulator(tc.parse_scene(SCENE.format(size=list(SIZE_M), density=density, model=MODEL, plate=plate)))
    closed_rad = np.arcsin(0.0035 / 2.0 / JAW_M)
    simulator.place("psm", joints(0.3)["psm"])
    simulator.advance(0.3)
    for k in range(100):
        simulator.advance(0.01, joints(0.3 + (closed_rad - 0.3) * (k + 1) / 100.0))
    simulator.advance(0.5)
    for k in range(20):
        s = (k + 1) / 20.0
        simulator.advance(0.1, joints(closed_rad, 0.02 * (10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5)))
    simulator.advance(0.5)
    assert np.mean(simulator.positions("stone")[:, 2]) == pytest.approx(0.5 * SIZE_M[2] + 0.02, abs=0.001)  # slides .56 mm
    assert simulator.wrench("psm", frame="world")[2] == pytest.approx(-9.81 * MASS_KG, rel=0.03)
