"""Write the model files of the package: `python -m tools.panda.write`."""

from pathlib import Path

from ictamp_drake.models import shapes
from ictamp_drake.models.contact import OBJECT
from tools.panda.panda import panda_sdf
from tools.panda.panda_visual import visual_files
from tools.panda.self_collision import ignored_pairs

FOLDER = Path(__file__).parents[2] / "ictamp_drake" / "models" / "sdf"


def contents() -> dict[str, str]:
    """Text of every file in `sdf/` by its name."""
    boxes = {
        f"{name}.sdf": shapes.box_sdf(name, size, shapes.BOX_MASS, OBJECT.friction, shapes.BOX_COLORS[name])
        for name, size in shapes.BOX_SIZES.items()
    }
    supports = {
        "table.sdf": shapes.table_sdf("table", shapes.TABLE_SIZE),
        "rack.sdf": shapes.rack_sdf("rack", shapes.RACK_SIZE),
    }
    return {"panda.sdf": panda_sdf(ignored_pairs()), **supports, **boxes, **visual_files()}


def main() -> None:
    """Write every file anew."""
    FOLDER.mkdir(exist_ok=True)
    for name, text in contents().items():
        (FOLDER / name).write_text(text)


if __name__ == "__main__":
    main()
