"""Provenance of results: commit, package versions and machine."""

import os
import platform
import re
from importlib import metadata
from typing import Any

from ictamp_drake.core.provenance import PACKAGE, commit


def provenance() -> dict[str, Any]:
    """Return commit, package versions and machine in types that YAML supports."""
    return {
        "commit": commit(PACKAGE),
        "versions": versions(),
        "host": {"cores": os.cpu_count(), "python": platform.python_version(), "platform": platform.platform()},
    }


def versions() -> dict[str, str]:
    """Return the versions of this package and its dependencies."""
    try:
        needed = metadata.requires("ictamp_drake") or []
    except metadata.PackageNotFoundError:
        return {"ictamp_drake": "not installed"}
    names = [re.split(r"[^\w.-]", each)[0] for each in needed if "extra ==" not in each]
    return {name: metadata.version(name) for name in ["ictamp_drake", *names]}
