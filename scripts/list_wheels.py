"""List the platforms for which each dependency has wheels: `python scripts/list_wheels.py`, a minute.

Asks pip for the files of each dependency in the version of constraints.txt, and downloads none. Writes a table to
docs/wheels.md. A cell holds the Pythons that have a wheel; "any" is a wheel for all of them.
"""

import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path

ROOT = Path(__file__).parents[1]
OUT = ROOT / "docs" / "wheels.md"
PYTHONS = ((3, 11), (3, 12), (3, 13), (3, 14))
PLATFORMS = {
    "Linux x86-64": r"manylinux.*x86_64|linux_x86_64",
    "Linux aarch64": r"manylinux.*aarch64",
    "macOS arm64": r"macosx.*(arm64|universal2)",
    "macOS x86-64": r"macosx.*(x86_64|universal2)",
    "Windows x86-64": r"win_amd64",
}
"""Patterns of the platform tags of wheels, by platform."""

_WHEEL = re.compile(r"/[^/]+?-(?P<version>[^/-]+)(-\d[^/-]*)?-(?P<python>[^/-]+)-(?P<abi>[^/-]+)-(?P<tags>[^/-]+)\.whl")

Wheel = tuple[str, str, str]
"""Tags of a wheel: Python, ABI and platforms."""


def dependencies() -> dict[str, str]:
    """Return the version of each dependency of the package in constraints.txt, by name."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    wanted = [*project["dependencies"], *extras["ik"], *extras["ray"], *extras["robots"]]
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    pinned = {name.lower().replace("_", "-"): version for name, _, version in (line.partition("==") for line in lines)}
    names = [re.split(r"[^\w-]", line)[0].lower() for line in wanted]
    return {name: pinned[name] for name in names}


def list_wheels(name: str, version: str) -> set[Wheel]:
    """Return the tags of the wheels of a version, from what pip says about the files that it finds."""
    command = [sys.executable, "-m", "pip", "index", "versions", name, "-vvv", "--disable-pip-version-check"]
    log = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = (match.groupdict() for match in _WHEEL.finditer(log))
    return {(wheel["python"], wheel["abi"], wheel["tags"]) for wheel in found if wheel["version"] == version}


def pythons(wheels: set[Wheel], platform: str) -> Iterator[tuple[int, int]]:
    """Yield the Pythons that have a wheel for a platform."""
    here = [each for each in wheels if each[2] == "any" or re.search(PLATFORMS[platform], each[2])]
    for version in PYTHONS:
        if any(fits(python, abi, version) for python, abi, _ in here):
            yield version


def fits(python: str, abi: str, version: tuple[int, int]) -> bool:
    """Return whether a wheel with these tags is for a version of Python."""
    tag = f"cp{version[0]}{version[1]}"
    oldest = [int(digits) for digits in re.findall(r"cp3(\d+)", python)]
    return (
        "py3" in python.split(".")
        or abi == tag
        or (python == tag and abi == "none")
        or ("abi3" in abi and bool(oldest) and min(oldest) <= version[1])
    )


def cell(versions: Sequence[tuple[int, int]], wheels: set[Wheel]) -> str:
    """Return the cell of a platform."""
    if any(tags == "any" for *_, tags in wheels):
        return "any"
    return ", ".join(f"{major}.{minor}" for major, minor in versions) or "-"


def main() -> None:
    """Ask pip about every dependency, and write the table."""
    rows = [["package", "version", *PLATFORMS], ["---"] * (2 + len(PLATFORMS))]
    everywhere = {platform: set(PYTHONS) for platform in PLATFORMS}
    for name, version in dependencies().items():
        wheels = list_wheels(name, version)
        found = {platform: list(pythons(wheels, platform)) for platform in PLATFORMS}
        rows.append([name, version, *(cell(found[platform], wheels) for platform in PLATFORMS)])
        for platform in PLATFORMS:
            everywhere[platform] &= set(found[platform])
        print(*rows[-1], sep="  ")
    rows.append(["**all**", "", *(cell(sorted(everywhere[platform]), set()) for platform in PLATFORMS)])
    text = [
        "# Wheels of the dependencies",
        "",
        "Pythons among 3.11 to 3.14 for which each dependency has a wheel, by platform, in the versions of",
        "constraints.txt. By `python scripts/list_wheels.py`.",
        "",
        *(f"| {' | '.join(row)} |" for row in rows),
        "",
    ]
    OUT.write_text("\n".join(text), encoding="utf-8")


if __name__ == "__main__":
    main()
