"""Reads exported models as their programs would: `read.py FORMAT FILE`. Prints what was read; fails if nothing was.

urdf is loaded by MuJoCo; modelica is parsed by pymoca, since no compiler of it is among the packages; sdf is parsed as XML;
isaaclab is run with classes that keep their arguments in place of Isaac Lab's.
"""

import json
import sys
import types
import xml.etree.ElementTree as ElementTree


def urdf(path):
    """Inertia, damping and friction of the joint, as MuJoCo has them."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(path)
    return {
        "inertia": float(model.body_inertia[-1][2]),
        "damping": float(model.dof_damping[0]),
        "friction": float(model.dof_frictionloss[0]),
    }


def modelica(path):
    """The names of the model's parts, by the grammar of Modelica."""
    from pymoca import parser

    with open(path, encoding="utf-8") as file:
        tree = parser.parse(file.read())
    if tree is None or "axis" not in tree.classes:
        raise SystemExit("the grammar does not take it")
    model = tree.classes["axis"]
    return {"symbols": sorted(model.symbols), "equations": len(model.equations)}


def sdf(path):
    """Damping and friction of the first joint."""
    root = ElementTree.parse(path).getroot()
    dynamics = root.find("model/joint/axis/dynamics")
    return {name: float(dynamics.findtext(name)) for name in ("damping", "friction")}


def isaaclab(path):
    """The arguments of the configuration."""
    classes = types.ModuleType("isaaclab.actuators")
    for name in ("IdealPDActuatorCfg", "DelayedPDActuatorCfg"):
        setattr(classes, name, lambda **arguments: arguments)
    sys.modules["isaaclab"] = types.ModuleType("isaaclab")
    sys.modules["isaaclab.actuators"] = classes
    scope = {}
    with open(path, encoding="utf-8") as file:
        exec(compile(file.read(), path, "exec"), scope)  # noqa: S102
    (found,) = [value for name, value in scope.items() if name.endswith("_CFG")]
    return found


if __name__ == "__main__":
    json.dump({"urdf": urdf, "modelica": modelica, "sdf": sdf, "isaaclab": isaaclab}[sys.argv[1]](sys.argv[2]), sys.stdout)
