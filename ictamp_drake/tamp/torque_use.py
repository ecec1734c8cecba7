"""Share of its torque limits that an arm uses in a plan."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ictamp_drake.core.types import FloatArray


@dataclass(frozen=True, kw_only=True)
class TorqueUse:
    """Largest share of a joint's torque limit that a plan's motions use.

    Attributes:
        share: Torque divided by its limit; more than 1 is beyond the limit.
        joint: Name of the joint.
        step: Number of the plan's step in which it happens, from 1.
    """

    share: float
    joint: str
    step: int

    def __str__(self) -> str:
        where = f"({self.joint}, step {self.step})"
        if self.share > 1:
            return f"Torque: beyond a joint's limit, at {100 * self.share:.0f} % of it {where}; the arm cannot do this."
        return f"Torque: at most {100 * self.share:.0f} % of a joint's limit {where}."


def largest(shares: FloatArray, joints: Sequence[str]) -> TorqueUse | None:
    """Return the largest of the shares of the joints in each step, shape (steps, n); None if no torque is used."""
    if not shares.any():
        return None
    step, joint = divmod(int(np.argmax(shares)), len(joints))
    return TorqueUse(share=round(float(shares[step, joint]), 4), joint=joints[joint], step=step + 1)
