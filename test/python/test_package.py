"""The package: messages without the compiled modules, ROS only where bags are read, types that tell of what there is."""
import ast
import inspect
import pathlib
import subprocess
import sys

import pytest

import tissue_contact as tc

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "doc/python"


def fresh(code):
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout


def test_messages_load_no_module():
    assert fresh("import sys, tissue_contact.msg, tissue_contact.srv; from tissue_contact.msg import Status\n"
                 "print([m for m in sys.modules if m.startswith('tissue_contact._')])").strip() == "[]"


def test_the_core_links_no_ros():
    maps = fresh("import tissue_contact as tc; tc.Simulator; print(open('/proc/self/maps').read())")
    assert "tissue_contact_core" in maps and "libros" not in maps and "tissue_contact_ros" not in maps


def test_what_is_not_there():
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        tc.nothing
    code = "import sys; sys.modules['tissue_contact._core'] = None\nimport tissue_contact as tc\ntry: tc.Simulator\nexcept ImportError as e: print(e)"
    assert "pybind11-dev" in fresh(code)


def members(cls):
    return {name for name in vars(cls) if not name.startswith("_")}


def test_types_are_those_of_the_modules():
    stub = ast.parse(pathlib.Path(tc.__file__).with_name("__init__.pyi").read_text())
    assert pathlib.Path(tc.__file__).with_name("py.typed").exists()
    told = {node.name: node for node in stub.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    told_numbers = {node.target.id for node in stub.body if isinstance(node, ast.AnnAssign)} - {"Path", "Settings", "JointPositions"}
    assert set(told) | told_numbers == set(tc.__all__)
    for name, node in told.items():
        if isinstance(node, ast.ClassDef) and name != "Replayed":
            in_stub = {one.name for one in node.body if isinstance(one, ast.FunctionDef) and not one.name.startswith("_")}
            assert in_stub == members(getattr(tc, name)), name
    for method in [one for one in told["Simulator"].body if isinstance(one, ast.FunctionDef) and not one.decorator_list]:
        signature = inspect.getdoc(getattr(tc.Simulator, method.name)).splitlines()[0]
        for argument in [one.arg for one in method.args.args + method.args.kwonlyargs][1:]:
            assert argument + ":" in signature, signature


def test_everything_is_told():
    for cls in (tc.Scene, tc.Simulator, tc.StepReport, tc.Topology, tc.Replayed):
        for name in members(cls):
            assert inspect.getdoc(getattr(cls, name)), "%s.%s" % (cls.__name__, name)


def run(example, *arguments, cwd):
    return subprocess.run([sys.executable, str(EXAMPLES / example), *map(str, arguments)], check=True, capture_output=True, text=True, cwd=cwd).stdout


def test_press_curve(tmp_path):
    lines = run("press_curve.py", "--output", "curve.png", "2500", "5000", cwd=tmp_path).splitlines()
    soft, stiff = [float(line.split(": ")[1].split()[0]) for line in lines]
    assert 1.8 < stiff / soft < 2.2  # both have the same geometry, and gravity is off
    assert (tmp_path / "curve.png").stat().st_size > 10000


def test_draw_drag(tmp_path):
    config = EXAMPLES.parents[1] / "config"
    said = run("draw_drag.py", config / "press_drag.yaml", config / "press_drag.bag", "--at", "1.0", "--output", "drag.png", cwd=tmp_path)
    replayed = tc.replay(config / "press_drag.yaml", config / "press_drag.bag", duration_s=1.1)
    stamps = replayed.stamps("probe")
    force = replayed.wrenches("probe")[abs(stamps - stamps[0] - 1.0).argmin(), :3]
    assert abs(float(said.split()[0]) - (force @ force) ** 0.5) < 2e-3
    assert 2.0 < float(said.split("moved by ")[1].split()[0]) < 4.5  # mm: of triangles under a ball that is 4 mm deep
    assert (tmp_path / "drag.png").stat().st_size > 30000


def test_closing_jaws(tmp_path):
    recorded, limited = run("closing_jaws.py", "--output", "jaws.png", "0.001", cwd=tmp_path).splitlines()
    squeeze, most, lift = [float(word) for word in limited.replace(",", "").split() if word.replace(".", "", 1).isdigit()][-3:]
    assert 0.11 < squeeze < most < 1.1 * squeeze  # never more on the way
    assert 0.028 < lift < 0.035
    # Crushed on the way; whether it is lost then (as with GCC 12) or not (GCC 9) is a matter of round-off.
    assert float(recorded.replace(",", "").split(" N at most")[0].split()[-1]) > 10.0 * squeeze
    assert (tmp_path / "jaws.png").stat().st_size > 10000


def test_gym_loop(tmp_path):
    first, second = run("gym_loop.py", cwd=tmp_path).splitlines()
    assert first.split(": ")[1] == second.split(": ")[1]  # the same bits
    assert abs(float(first.split(": ")[1].split()[0]) - 0.1) < 0.005


def test_friction_table(tmp_path):
    rows = [[float(number) for number in line.split()] for line in run("friction_table.py", cwd=tmp_path).splitlines()[1:]]
    assert len(rows) > 5
    assert sorted(abs(got - measured) / measured for _, measured, got in rows)[len(rows) // 2] < 0.15


OTHER_COLUMNS, OTHER_CELLS = "is no table with the columns pressure_pa,coefficient", "needs rows with a finite number in each cell"


@pytest.mark.parametrize("table, what", [
    ("load_n,mu\n1,2\n", OTHER_COLUMNS), ("pressure_pa,coefficient\n100\n", OTHER_COLUMNS), ("", OTHER_COLUMNS), (None, "cannot be read"),
    ("pressure_pa,coefficient\n100,0.5\n200,\n", OTHER_CELLS), ("pressure_pa,coefficient\n100,inf\n", OTHER_CELLS), ("pressure_pa,coefficient\n", OTHER_CELLS)])
def test_a_friction_table_of_another_form(tmp_path, table, what):
    if table is not None:
        (tmp_path / "other.csv").write_text(table)
    with pytest.raises(subprocess.CalledProcessError) as refused:
        run("friction_table.py", "other.csv", cwd=tmp_path)
    assert refused.value.stderr.splitlines()[-1].startswith("friction_table.py: other.csv " + what)


def test_a_friction_table_of_one_row(tmp_path):
    (tmp_path / "one.csv").write_text("pressure_pa,coefficient\n1000,0.5\n")
    rows = [line.split() for line in run("friction_table.py", "one.csv", cwd=tmp_path).splitlines()[1:]]
    assert {measured for _, measured, _ in rows} == {"0.50"}
