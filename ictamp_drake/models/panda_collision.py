"""Collision geometry of the Panda: primitives around the real links."""

import math

from ictamp_drake.models.contact import CONTACT_RADIUS, PAD_CONTACT_PROUD
from ictamp_drake.models.sdf_text import Shape

PAD_HALF_WIDTH = 0.0105
PAD_HALF_HEIGHT = 0.0095
PAD_THICKNESS = 0.0155
PAD_CENTRE = 0.045
"""Height of the pad's centre above the finger's frame, so that it stands in the grasp frame G [m]."""

LINKS: dict[str, tuple[Shape, ...]] = {
    "panda_link0": (Shape("base", "box", (0.226, 0.19, 0.14), (-0.0413, 0.0, 0.07)),),
    "panda_link1": (
        Shape("column", "cylinder", (0.062, 0.14), (0.0, 0.0, -0.122)),
        Shape("shoulder", "capsule", (0.062, 0.08), (0.0, -0.035, 0.0), (math.pi / 2, 0.0, 0.0)),
    ),
    "panda_link2": (
        Shape("column", "cylinder", (0.062, 0.14), (0.0, -0.122, 0.0), (math.pi / 2, 0.0, 0.0)),
        Shape("shoulder", "capsule", (0.062, 0.08), (0.0, 0.0, 0.035)),
    ),
    "panda_link3": (
        Shape("column", "cylinder", (0.062, 0.12), (0.0, 0.0, -0.06)),
        Shape("elbow", "capsule", (0.06, 0.06), (0.0825, 0.03, 0.0), (math.pi / 2, 0.0, 0.0)),
    ),
    "panda_link4": (
        Shape("elbow", "capsule", (0.06, 0.06), (0.0, 0.0, 0.03)),
        Shape("column", "cylinder", (0.062, 0.12), (-0.0825, 0.06, 0.0), (math.pi / 2, 0.0, 0.0)),
    ),
    "panda_link5": (
        Shape("column", "cylinder", (0.062, 0.08), (0.0, 0.0, -0.225)),
        Shape("forearm", "capsule", (0.05, 0.15), (0.0, 0.06, -0.13)),
        Shape("wrist", "capsule", (0.056, 0.08), (0.0, 0.035, 0.0), (math.pi / 2, 0.0, 0.0)),
    ),
    "panda_link6": (
        Shape("wrist", "cylinder", (0.055, 0.1), (0.0, 0.0, 0.0)),
        Shape("flange", "capsule", (0.055, 0.05), (0.08, 0.02, 0.0), (math.pi / 2, 0.0, 0.0)),
    ),
    "panda_link7": (
        Shape("flange", "cylinder", (0.048, 0.056), (0.0, 0.0, 0.08)),
        Shape("plug", "box", (0.06, 0.06, 0.05), (0.045, 0.045, 0.08), (0.0, 0.0, math.pi / 4)),
    ),
    "panda_hand": (Shape("palm", "box", (0.0632, 0.208, 0.092), (0.0, 0.0, 0.02)),),
}

FINGER = (
    Shape("mount", "box", (0.021, 0.024, 0.019), (0.0, 0.0145, 0.0095)),
    Shape("stem", "box", (0.021, 0.012, 0.0165), (0.0, 0.019, 0.02725)),
)
PAD = Shape(
    "pad",
    "box",
    (2 * PAD_HALF_WIDTH, PAD_THICKNESS, 2 * PAD_HALF_HEIGHT),
    (0.0, PAD_THICKNESS / 2, PAD_CENTRE),
)
PAD_CONTACTS = tuple(
    Shape(
        f"pad_contact_{2 * i + j}",
        "sphere",
        (CONTACT_RADIUS,),
        (
            x * (PAD_HALF_WIDTH - CONTACT_RADIUS),
            CONTACT_RADIUS - PAD_CONTACT_PROUD,
            PAD_CENTRE + z * (PAD_HALF_HEIGHT - CONTACT_RADIUS),
        ),
    )
    for i, x in enumerate((-1.0, 1.0))
    for j, z in enumerate((-1.0, 1.0))
)
