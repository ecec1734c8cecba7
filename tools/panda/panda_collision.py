"""Collision geometry of the Panda: primitives that contain the real links and protrude from them by less than 2 cm.

They protrude from the hand by less than 1 cm, and from the fingers by less than 5 mm. The tests measure this on meshes.
"""

import math

from ictamp_drake.models.contact import CONTACT_RADIUS, PAD_CONTACT_PROUD
from ictamp_drake.models.panda import PAD_CENTER, PAD_HALF_HEIGHT, PAD_HALF_WIDTH, PAD_THICKNESS
from ictamp_drake.models.sdf_text import Shape

ALONG_Y = (math.pi / 2, 0.0, 0.0)

LINKS: dict[str, tuple[Shape, ...]] = {
    "panda_link0": (
        Shape("tower", "cylinder", (0.0606, 0.1405), (-0.0046, 0.0, 0.07025)),
        Shape("front", "cylinder", (0.0743, 0.104), (0.0, 0.0, 0.052)),
        Shape("ribs", "box", (0.065, 0.1556, 0.09), (-0.0075, 0.0, 0.045)),
        Shape("rear", "box", (0.039, 0.111, 0.072), (-0.1045, 0.0, 0.036)),
        Shape("rear_tip", "box", (0.0175, 0.0916, 0.062), (-0.12675, 0.0, 0.031)),
        Shape("middle", "box", (0.0545, 0.1252, 0.0865), (-0.06225, 0.0, 0.04325)),
        Shape("slope", "box", (0.098, 0.108, 0.04), (-0.0769, 0.0, 0.0748), (0.0, -0.675, 0.0)),
        Shape("socket", "box", (0.0345, 0.0236, 0.033), (-0.06675, -0.0668, 0.045)),
        Shape("plate_rear", "box", (0.0346, 0.144, 0.0108), (-0.1373, 0.0, 0.0054)),
        Shape("plate_middle", "box", (0.061, 0.17, 0.0108), (-0.0905, 0.0, 0.0054)),
        Shape("plate_front", "box", (0.083, 0.1906, 0.0108), (-0.0195, 0.0, 0.0054)),
    ),
    "panda_link1": (
        Shape("column", "cylinder", (0.0582, 0.1058), (0.0, -0.0021, -0.1472)),
        Shape("neck_left", "capsule", (0.0468, 0.1424), (0.0104, -0.0442, -0.0647), (0.549, 0.0, 0.0)),
        Shape("neck_right", "capsule", (0.0468, 0.1424), (-0.0104, -0.0442, -0.0647), (0.549, 0.0, 0.0)),
        Shape("shoulder", "cylinder", (0.0652, 0.0856), (0.0, -0.0394, -0.005), ALONG_Y),
        Shape("shoulder_cap", "sphere", (0.0647,), (0.0, -0.0756, -0.0047)),
    ),
    "panda_link2": (
        Shape("column", "cylinder", (0.058, 0.1054), (0.0, -0.1467, 0.0018), ALONG_Y),
        Shape("neck_left", "capsule", (0.0455, 0.1312), (0.0121, -0.0675, 0.0427), (-0.999, 0.0, 0.0)),
        Shape("neck_right", "capsule", (0.0455, 0.1312), (-0.0121, -0.0675, 0.0427), (-0.999, 0.0, 0.0)),
        Shape("shoulder", "cylinder", (0.0648, 0.0706), (0.0, -0.0075, 0.0339)),
        Shape("shoulder_cap", "sphere", (0.0644,), (0.0, 0.0009, 0.0671)),
    ),
    "panda_link3": (
        Shape("column", "cylinder", (0.0562, 0.073), (-0.0001, -0.0005, -0.0862)),
        Shape("bend", "sphere", (0.0609,), (0.0098, 0.0026, -0.061)),
        Shape("elbow", "cylinder", (0.0607, 0.085), (0.0787, 0.0396, -0.0013), ALONG_Y),
        Shape("elbow_cap", "sphere", (0.0646,), (0.0761, 0.0574, -0.0047)),
    ),
    "panda_link4": (
        Shape("column", "cylinder", (0.0576, 0.0846), (-0.0814, 0.0894, -0.0008), ALONG_Y),
        Shape("bend", "sphere", (0.0609,), (-0.0722, 0.0599, 0.0053)),
        Shape("elbow", "cylinder", (0.0592, 0.0812), (-0.0026, 0.0009, 0.0356)),
        Shape("elbow_cap", "sphere", (0.0642,), (-0.0071, 0.0045, 0.059)),
    ),
    "panda_link5": (
        Shape("column", "cylinder", (0.0625, 0.084), (0.0, 0.0067, -0.2263)),
        Shape("shoulder", "sphere", (0.0605,), (0.0, 0.0276, -0.203)),
        Shape("forearm", "box", (0.0752, 0.0508, 0.1732), (0.0, 0.0823, -0.1156), (-0.251, 0.0, 0.0)),
        Shape("wrist", "cylinder", (0.052, 0.099), (0.0, 0.0577, -0.0017), ALONG_Y),
        Shape("wrist_cap", "sphere", (0.0613,), (0.0, 0.0825, -0.0063)),
    ),
    "panda_link6": (
        Shape("wrist", "cylinder", (0.0525, 0.0704), (0.003, 0.0007, 0.0145)),
        Shape("wrist_top", "cylinder", (0.0456, 0.0756), (0.0168, 0.0, 0.0202)),
        Shape("bridge", "box", (0.0714, 0.0802, 0.055), (0.036, 0.0232, 0.0062)),
        Shape("flange", "cylinder", (0.0539, 0.1084), (0.0817, -0.0007, 0.0018), ALONG_Y),
        Shape("flange_cap", "sphere", (0.0538,), (0.0775, 0.0408, 0.0022)),
    ),
    "panda_link7": (
        Shape("flange", "cylinder", (0.054, 0.0572), (-0.0001, -0.0006, 0.0787)),
        Shape("button", "box", (0.053, 0.0714, 0.0364), (0.044, 0.0437, 0.0819), (0.0, 0.0, 0.773)),
    ),
    "panda_hand": (
        Shape("palm", "box", (0.0386, 0.2016, 0.0539), (0.0, 0.0, 0.03945)),
        Shape("flange", "cylinder", (0.0322, 0.0117), (0.0, 0.0, 0.00285)),
        Shape("base", "box", (0.04, 0.1923, 0.015), (0.0, -0.00015, 0.0055)),
        Shape("front", "box", (0.0584, 0.0634, 0.0171), (0.0, 0.0577, -0.00085)),
        Shape("back_edge", "box", (0.0376, 0.0648, 0.0084), (0.0, -0.0584, -0.0052)),
        Shape("front_edge", "box", (0.0522, 0.0258, 0.0197), (0.0, 0.0839, 0.00735)),
        Shape("front_taper", "box", (0.0486, 0.0303, 0.045), (0.0, 0.08565, 0.0365)),
        Shape("socket", "box", (0.0126, 0.0465, 0.019), (0.0, -0.06775, -0.0175)),
        Shape("plug", "box", (0.0092, 0.0162, 0.038), (0.0, -0.0961, -0.004)),
    ),
}
"""The primitives of every link except the fingers."""

FINGER: tuple[Shape, ...] = (
    Shape("rail", "box", (0.0217, 0.0246, 0.0048), (0.0, 0.0144, 0.0021)),
    Shape("mount", "box", (0.0217, 0.0164, 0.0164), (0.0, 0.0185, 0.0117)),
    Shape("stem", "box", (0.0214, 0.0084, 0.0272), (0.0, 0.0157, 0.029), (0.524, 0.0, 0.0)),
)
PAD = Shape(
    "pad",
    "box",
    (2 * PAD_HALF_WIDTH, PAD_THICKNESS, 2 * PAD_HALF_HEIGHT),
    (0.0, PAD_THICKNESS / 2, PAD_CENTER),
)
PAD_CONTACTS = tuple(
    Shape(
        f"pad_contact_{2 * i + j}",
        "sphere",
        (CONTACT_RADIUS,),
        (
            x * (PAD_HALF_WIDTH - CONTACT_RADIUS),
            CONTACT_RADIUS - PAD_CONTACT_PROUD,
            PAD_CENTER + z * (PAD_HALF_HEIGHT - CONTACT_RADIUS),
        ),
    )
    for i, x in enumerate((-1.0, 1.0))
    for j, z in enumerate((-1.0, 1.0))
)
