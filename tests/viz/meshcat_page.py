"""Content of Meshcat, read from the page that its server offers for download."""

import base64
import re
import struct
import urllib.request

import numpy as np

COMMAND = re.compile(r'fetch\("data:application/octet-binary;base64,([A-Za-z0-9+/=]+)"\)')


def download(url: str) -> list[bytes]:
    """Commands that make up the scene."""
    with urllib.request.urlopen(f"{url}/download") as reply:
        return [base64.b64decode(text) for text in COMMAND.findall(reply.read().decode())]


def position(commands: list[bytes], path: str) -> np.ndarray:
    """Latest position of a path's origin [m], shape (3,)."""
    start = path.encode() + b"\xa6matrix\xdc\x00\x10"  # MessagePack: key of 6 characters, array of 16
    (command,) = (c for c in commands if start in c)
    numbers = command.partition(start)[2]
    matrix = [struct.unpack(">d", numbers[9 * i + 1 : 9 * i + 9])[0] for i in range(16)]
    return np.array(matrix[12:15])


def objects(commands: list[bytes]) -> int:
    """Number of objects drawn in the scene."""
    return sum(b"set_object" in c and b"/scene/" in c for c in commands)
