"""How surfaces touch: friction and compliance of every collision geometry, in one place."""

from typing import NamedTuple


class Surface(NamedTuple):
    """Contact properties of a geometry.

    Attributes:
        friction: Coulomb coefficient, static and dynamic.
        stiffness: of point contact [N/m].
        dissipation: Hunt and Crossley's [s/m].
        relaxation_time: of SAP's linear dissipation [s].
    """

    friction: float
    stiffness: float
    dissipation: float
    relaxation_time: float


BODY = Surface(friction=0.5, stiffness=1e5, dissipation=1.0, relaxation_time=0.01)
"""The arm's links and the hand, which ought to touch nothing."""
PAD = Surface(friction=1.0, stiffness=1e5, dissipation=5.0, relaxation_time=0.01)
"""The finger pads and their contact points."""
SUPPORT = Surface(friction=1.0, stiffness=1e5, dissipation=5.0, relaxation_time=0.01)
"""Tables and racks."""
OBJECT = Surface(friction=1.0, stiffness=1e5, dissipation=5.0, relaxation_time=0.01)
"""Boxes; their friction is given for each of them."""

CONTACT_RADIUS = 0.002
"""Radius of the small spheres that stand for a face's corners [m]."""
PAD_CONTACT_PROUD = 0.0002
"""How far the pads' contact spheres stand out of the pad [m]."""
