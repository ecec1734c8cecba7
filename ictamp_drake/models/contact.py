"""Contact properties of all collision geometries in one place: friction and compliance."""

from typing import NamedTuple


class Surface(NamedTuple):
    """Contact properties of a geometry.

    Attributes:
        friction: Coefficient of Coulomb friction, static and dynamic.
        stiffness: Stiffness of point contact [N/m].
        dissipation: Hunt-Crossley dissipation [s/m].
        relaxation_time: Relaxation time of SAP's linear dissipation [s].
    """

    friction: float
    stiffness: float
    dissipation: float
    relaxation_time: float


BODY = Surface(friction=0.5, stiffness=1e5, dissipation=1.0, relaxation_time=0.01)
"""The arm's links and the hand, which should touch nothing."""
PAD = Surface(friction=1.0, stiffness=1e5, dissipation=5.0, relaxation_time=0.01)
"""The finger pads and their contact points."""
SUPPORT = Surface(friction=1.0, stiffness=1e5, dissipation=5.0, relaxation_time=0.01)
"""Tables and racks."""
OBJECT = Surface(friction=1.0, stiffness=1e5, dissipation=5.0, relaxation_time=0.01)
"""Boxes. Each box has its own friction."""

CONTACT_RADIUS = 0.002
"""Radius of the small spheres that represent a face's corners [m]."""
PAD_CONTACT_PROUD = 0.0002
"""Distance that the pads' contact spheres protrude from the pad [m]."""
