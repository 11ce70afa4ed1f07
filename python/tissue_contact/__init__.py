"""Contact of surgical instruments with soft tissue: scenes, stepping and replays from Python. See doc/python.md.

    import tissue_contact as tc
    simulator = tc.Simulator(tc.load_scene("scene.yaml", set={"tissues.block.material.youngs_modulus_pa": 4000.0}))
    simulator.advance(0.002, {"probe": [0.0, 0.0, -0.001]})
    force_n = simulator.wrench("probe")[:3]

The compiled modules are loaded with the first name that is used of them, so that messages (tissue_contact.msg, .srv) need neither.
"""
import importlib

_MODULES = {name: "_core" for name in
            ["Scene", "Simulator", "StepReport", "Topology", "load_scene", "parse_scene", "OPEN", "STATIC", "KINETIC"]}
_MODULES.update({"replay": "_replayed", "Replayed": "_replayed"})
__all__ = sorted(_MODULES)


def __getattr__(name):
    if name not in _MODULES:
        raise AttributeError("module 'tissue_contact' has no attribute %r" % name)
    try:
        module = importlib.import_module("." + _MODULES[name], __name__)
    except ImportError as error:
        raise ImportError("tissue_contact.%s: %s. The simulator in Python is built where pybind11-dev, python3-dev and python3-numpy are "
                          "installed, and its libraries are found after `source scripts/env.bash` or setup.bash" % (name, error)) from error
    globals()[name] = getattr(module, name)
    return globals()[name]


def __dir__():
    return sorted(set(globals()) | set(__all__))
