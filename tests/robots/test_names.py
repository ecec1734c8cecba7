"""Only files of robots name joints and links of robots."""

import re
from pathlib import Path

import ictamp_drake

PACKAGE = Path(ictamp_drake.__file__).parent
NAMES = re.compile(
    r"panda_(link|joint|hand|left|right|finger)|iiwa_(link|joint)|wsg_(body|left|right)|shoulder_pan|outer_knuckle"
)


def test_code_names_no_joint_and_no_link() -> None:
    found = {
        str(path.relative_to(PACKAGE)): match[0]
        for path in PACKAGE.rglob("*.py")
        if (match := NAMES.search(path.read_text(encoding="utf-8")))
    }
    assert set(found) == {"models/panda.py"}, found  # from which the Panda's model is written
