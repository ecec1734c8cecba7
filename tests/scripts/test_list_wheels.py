"""Tags of wheels are read as pip reads them."""

import pytest

from scripts.list_wheels import dependencies, pythons

LINUX, MAC = "manylinux_2_34_x86_64", "macosx_15_0_arm64"


@pytest.mark.parametrize(
    ("wheel", "platform", "minors"),
    [
        (("cp312", "cp312", LINUX), "Linux x86-64", [12]),
        (("cp312", "cp312", LINUX), "macOS arm64", []),
        (("cp313", "cp313t", LINUX), "Linux x86-64", []),
        (("cp310", "abi3", LINUX), "Linux x86-64", [11, 12, 13, 14]),
        (("cp313", "abi3", MAC), "macOS arm64", [13, 14]),
        (("py3", "none", "any"), "Windows x86-64", [11, 12, 13, 14]),
        (("py2.py3", "none", "win_amd64"), "Windows x86-64", [11, 12, 13, 14]),
        (("cp312", "cp312", "macosx_10_9_universal2"), "macOS x86-64", [12]),
    ],
)
def test_a_wheel_is_for_some_pythons(wheel: tuple[str, str, str], platform: str, minors: list[int]) -> None:
    assert [minor for _, minor in pythons({wheel}, platform)] == minors


def test_every_dependency_has_a_version() -> None:
    assert {"drake", "ompl", "scikit-learn", "ray"} <= dependencies().keys()
