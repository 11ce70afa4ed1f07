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


FLAP = """
gravity_m_per_s2: [0, 0, 0]
tissues:
  - name: flap
    block: {{size_m: [0.004, 0.01, 0.03], cells: [4, 8, 12]}}
    refinement: never
    material: {{model: neo_hookean, youngs_modulus_pa: 20000, poissons_ratio: 0.3, density_kg_per_m3: 1000}}
    damping: {{stiffness_s: 0.003, mass_per_s: 20}}
    fixed: [{{plane: {{point_m: [0, 0, 0], normal: [0, 0, 1]}}}}]
instruments:
  - name: psm
    urdf: {model}
    base_pose: {{position_m: [-0.25, 0, -0.311]}}
    joint_state_topics: [/psm/js]
    tip_link: PSM2_tool_wrist_caudier_ee_link
    contact_links: [PSM2_tool_wrist_caudier_link_2_left, PSM2_tool_wrist_caudier_link_2_right]
{compliance}
friction:
  - {{instrument: psm, tissue: flap, static: 0.6, kinetic: 0.4}}
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


@pytest.mark.skipif(not MODEL.is_file(), reason="no shared data with the model of a PSM")
@pytest.mark.parametrize("closes_in_s", [1.0, 0.1])
def test_compliant_jaws_hold_tissue_that_the_recorded_position_would_squeeze_out(closes_in_s):
    """A recording made without tissue closes the jaws to 0 and below; a limit of .008 N m on their joint is .46 N a jaw at 17.5 mm."""

    def pull(compliance):
        simulator = tc.Simulator(tc.parse_scene(FLAP.format(model=MODEL, compliance=compliance)))
        simulator.place("psm", joints(0.25)["psm"])
        steps = round(closes_in_s / 0.01)
        too_much = 0
        for k in range(steps):
            simulator.advance(0.01, joints(0.25 - 0.45 * (k + 1) / steps))
            too_much += bool(simulator.report().implausible_load)
        contacts = simulator.contacts()
        squeeze_n = 0.5 * np.abs((contacts["force"] * contacts["normal"]).sum(axis=1)).sum()
        for k in range(100):
            simulator.advance(0.01, joints(-0.2, 0.00003 * (k + 1)))
        return too_much, squeeze_n, simulator.wrench("psm", frame="world")[2], simulator.joint_deflections("psm")

    too_much, squeeze_n, force_n, deflections = pull("    compliant_joints: [{joint: jaw, stiffness_n_m_per_rad: 0.5, torque_limit_n_m: 0.008}]")
    assert too_much == 0
    assert squeeze_n == pytest.approx(0.43, rel=0.1)
    assert force_n == pytest.approx(-0.073, rel=0.1)
    assert deflections[-1] == pytest.approx(0.505, rel=0.02) and not deflections[:-1].any()
    too_much, _, _, none = pull("")
    assert too_much > 0 and not none.any()
