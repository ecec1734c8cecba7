"""SDF elements as text: poses, inertias, shapes with color or with contact properties."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple
from xml.etree import ElementTree

from ictamp_drake.models.contact import Surface

DRAKE_NAMESPACE = "http://drake.mit.edu"

Color = tuple[float, float, float]

_TINY = 1e-30
"""Magnitude up to which a number is 0; the parser refuses numbers that are too small for 32 bits."""


class Inertial(NamedTuple):
    """Mass [kg], center of mass p_LLcm [m], inertia about it (xx, yy, zz, xy, xz, yz) in the link's axes [kg m^2]."""

    mass: float
    p_LLcm: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]


class Shape(NamedTuple):
    """A primitive in its link's frame.

    Attributes:
        name: Name that is unique in the link.
        kind: One of "box", "cylinder", "capsule" and "sphere".
        size: Dimensions (x, y, z), (radius, length), (radius, length) or (radius,), in the order of the kinds [m].
        xyz: Position of the center [m].
        rpy: Roll, pitch, yaw [rad].
    """

    name: str
    kind: str
    size: tuple[float, ...]
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)


def numbers(values: Iterable[float]) -> str:
    """The values with twelve digits, separated by spaces; -0 and what is close to 0 are written as 0."""
    return " ".join(f"{value if abs(value) > _TINY else 0.0:.12g}" for value in values)


def pose(xyz: Sequence[float], rpy: Sequence[float] = (0.0, 0.0, 0.0), relative_to: str = "") -> str:
    """A pose element, in the named frame or in the default one."""
    frame = f' relative_to="{relative_to}"' if relative_to else ""
    return f"<pose{frame}>{numbers((*xyz, *rpy))}</pose>"


def inertial(value: Inertial) -> str:
    """The inertial element."""
    tags = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    inertia = "".join(f"<{tag}>{numbers((number,))}</{tag}>" for tag, number in zip(tags, value.inertia, strict=True))
    mass = numbers((value.mass,))
    return f"<inertial>{pose(value.p_LLcm)}<mass>{mass}</mass><inertia>{inertia}</inertia></inertial>"


def _geometry(shape: Shape) -> str:
    if shape.kind == "box":
        inside = f"<size>{numbers(shape.size)}</size>"
    elif shape.kind == "sphere":
        inside = f"<radius>{numbers(shape.size)}</radius>"
    else:
        radius, length = shape.size
        inside = f"<radius>{numbers((radius,))}</radius><length>{numbers((length,))}</length>"
    return f"<geometry><{shape.kind}>{inside}</{shape.kind}></geometry>"


def collision(shape: Shape, surface: Surface) -> str:
    """A collision element with its contact properties."""
    properties = (
        ("drake:mu_static", surface.friction),
        ("drake:mu_dynamic", surface.friction),
        ("drake:point_contact_stiffness", surface.stiffness),
        ("drake:hunt_crossley_dissipation", surface.dissipation),
        ("drake:relaxation_time", surface.relaxation_time),
    )
    inside = "".join(f"<{tag}>{numbers((value,))}</{tag}>" for tag, value in properties)
    return (
        f'<collision name="{shape.name}">{pose(shape.xyz, shape.rpy)}{_geometry(shape)}'
        f"<drake:proximity_properties>{inside}</drake:proximity_properties></collision>"
    )


def visual(shape: Shape, color: Color) -> str:
    """A visual element of one color (red, green, blue in [0, 1])."""
    return (
        f'<visual name="{shape.name}">{pose(shape.xyz, shape.rpy)}{_geometry(shape)}'
        f"<material><diffuse>{numbers((*color, 1.0))}</diffuse></material></visual>"
    )


def mesh_visual(uri: str) -> str:
    """A visual element with the colors of a glTF file."""
    return f'<visual name="mesh"><geometry><mesh><uri>{uri}</uri></mesh></geometry></visual>'


def element(tag: str, children: Iterable[str], **attributes: str) -> str:
    """An element around its children."""
    head = "".join(f' {name}="{value}"' for name, value in attributes.items())
    return f"<{tag}{head}>{''.join(children)}</{tag}>"


def document(model: str) -> str:
    """A complete SDF file around one model, indented."""
    ElementTree.register_namespace("drake", DRAKE_NAMESPACE)
    root = ElementTree.fromstring(f'<sdf version="1.9" xmlns:drake="{DRAKE_NAMESPACE}">{model}</sdf>')
    ElementTree.indent(root)
    return f'<?xml version="1.0"?>\n{ElementTree.tostring(root, encoding="unicode")}\n'
