"""Write the files in `sdf/`: `python -m ictamp_drake.models.write`."""

from pathlib import Path

from ictamp_drake.models.panda import panda_sdf

FOLDER = Path(__file__).parent / "sdf"


def contents() -> dict[str, str]:
    """Text of every file in `sdf/` by its name."""
    return {"panda.sdf": panda_sdf()}


def main() -> None:
    """Write every file anew."""
    FOLDER.mkdir(exist_ok=True)
    for name, text in contents().items():
        (FOLDER / name).write_text(text)


if __name__ == "__main__":
    main()
