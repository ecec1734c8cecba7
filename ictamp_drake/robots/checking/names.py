"""Checks of the names in a robot file."""

from collections.abc import Callable, Iterable, Iterator
from functools import partial

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.robots.bodies import find_frame, find_joint, name_links
from ictamp_drake.robots.checking.models import Models
from ictamp_drake.robots.model_files import add_model
from ictamp_drake.robots.spec import RobotSpec


def check_names(spec: RobotSpec, models: Models) -> list[IctampError]:
    """Return a mistake for each body, frame and joint that the models do not have."""
    plant = MultibodyPlant(0.0)
    arm = held = add_model(plant, models.arm, "visible", frozenset(), "model")
    if models.gripper is not None:
        held = add_model(plant, models.gripper, "visible", frozenset(), "gripper.model")
    gripper, pads = spec.gripper, spec.gripper.pads
    frames = [(arm, spec.base, "base"), (arm, spec.flange, "flange")]
    frames += [(arm, name, f"collision.{name}") for name in spec.collision]
    frames += [(held, gripper.base, "gripper.base"), (held, gripper.grasp.frame, "gripper.grasp.frame")]
    frames += [(held, pads.first.frame, "gripper.pads.first"), (held, pads.second.frame, "gripper.pads.second")]
    frames += [(held, name, f"gripper.collision.{name}") for name in gripper.collision]
    if models.gripper is not None and gripper.mount is not None:
        frames.append((held, gripper.mount.frame, "gripper.mount.frame"))
    joints = [(arm, name, f"joints[{number}]") for number, name in enumerate(spec.joints)]
    joints += [(held, name, f"gripper.joints[{number}]") for number, name in enumerate(gripper.joints)]
    calls: list[Callable[[], object]] = [partial(find_frame, plant, *frame) for frame in frames]
    calls += [partial(find_joint, plant, *joint) for joint in joints]
    return [*_refusals(calls), *_check_touching(spec, plant, (arm, held)), *_check_repeated(spec, is_one=arm == held)]


def _check_repeated(spec: RobotSpec, *, is_one: bool) -> Iterator[IctampError]:
    """Yield joints that are listed for the arm and for the gripper, where both are one model."""
    for number, name in enumerate(spec.gripper.joints):
        if is_one and name in spec.joints:
            problem, field = "expected a joint of the gripper, got {value} of the arm", f"gripper.joints[{number}]"
            yield IctampError(Code.REPEATED, problem, field=field, value=name)


def _refusals(calls: Iterable[Callable[[], object]]) -> Iterator[IctampError]:
    for call in calls:
        try:
            call()
        except IctampError as error:
            yield error


def _check_touching(
    spec: RobotSpec, plant: MultibodyPlant, instances: tuple[ModelInstanceIndex, ...]
) -> Iterator[IctampError]:
    indices = [index for each in dict.fromkeys(instances) for index in plant.GetBodyIndices(each)]
    names = name_links(map(plant.get_body, indices))
    for number, pair in enumerate(spec.touching or ()):
        for name in pair:
            if name not in names:
                problem, field = "there is no body {value}", f"touching[{number}]"
                yield IctampError(Code.UNKNOWN_CHOICE, problem, field=field, value=name, choices=names)
