"""Parts of a robot's SDF: joints with their limits, frames and collision filters."""

from collections.abc import Iterable

from ictamp_drake.models.sdf_text import element, numbers, pose

Pair = tuple[str, str]
"""Names of two links."""


def limit(lower: float, upper: float, velocity: float, effort: float, acceleration: float | None = None) -> str:
    """The limits of a joint."""
    values = {"lower": lower, "upper": upper, "effort": effort, "velocity": velocity}
    inside = [f"<{tag}>{numbers((value,))}</{tag}>" for tag, value in values.items()]
    if acceleration is not None:
        inside.append(f"<drake:acceleration>{numbers((acceleration,))}</drake:acceleration>")
    return element("limit", inside)


def axis(xyz: tuple[int, int, int], limits: str, damping: float) -> str:
    """The axis of a joint, with its limits and its viscous friction."""
    dynamics = f"<dynamics><damping>{numbers((damping,))}</damping></dynamics>"
    return element("axis", [f"<xyz>{numbers(xyz)}</xyz>", limits, dynamics])


def joint(name: str, kind: str, parent: str, child: str, *inside: str) -> str:
    """A joint between two links."""
    return element("joint", [f"<parent>{parent}</parent>", f"<child>{child}</child>", *inside], name=name, type=kind)


def mimic(leader: str) -> str:
    """What makes a joint follow another one, position by position."""
    return element("drake:mimic", [], joint=leader, multiplier="1", offset="0")


def frame(name: str, attached_to: str, z: float) -> str:
    """A frame ahead of a link's frame along its z axis."""
    return element("frame", [pose((0.0, 0.0, z))], name=name, attached_to=attached_to)


def collision_filter(links: Iterable[str], ignored_pairs: Iterable[Pair]) -> list[str]:
    """One filter group for each link, named `only_LINK`, which ignores those of the links it is paired with."""
    others: dict[str, list[str]] = {name: [] for name in links}
    for first, second in ignored_pairs:
        others[first].append(second)
    return [
        element(
            "drake:collision_filter_group",
            [
                f"<drake:member>{name}</drake:member>",
                *(
                    f"<drake:ignored_collision_filter_group>only_{n}</drake:ignored_collision_filter_group>"
                    for n in names
                ),
            ],
            name=f"only_{name}",
        )
        for name, names in others.items()
    ]
