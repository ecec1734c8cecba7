"""Write the model files of the package: `python -m tools.write`.

Size, mass, friction and color of boxes and supports are taken from their existing files. To change one, edit the file's
solid shape, its `mass`, its `mu_static` or its last visual, and run this script. The rest follows.
"""

from ictamp_drake.models import shapes
from ictamp_drake.models.things import BOXES, FOLDER, read_thing
from tools.iiwa import iiwa, iiwa_visual, wsg
from tools.iiwa import self_collision as iiwa_pairs
from tools.panda import panda_visual
from tools.panda import self_collision as panda_pairs
from tools.panda.panda import panda_sdf


def contents() -> dict[str, str]:
    """Text of every file in `sdf/`, by file name."""
    boxes = {f"{name}.sdf": shapes.box_sdf(name, *read_thing(name)) for name in BOXES}
    supports = {
        "table.sdf": shapes.table_sdf("table", read_thing("table").size),
        "rack.sdf": shapes.rack_sdf("rack", read_thing("rack").size),
    }
    ignored = iiwa_pairs.ignored_pairs()
    robots = {
        "panda.sdf": panda_sdf(panda_pairs.ignored_pairs()),
        "iiwa14.sdf": iiwa.iiwa_sdf(iiwa_pairs.within(iiwa.LINKS, ignored)),
        "wsg50.sdf": wsg.wsg_sdf(iiwa_pairs.within(wsg.LINKS, ignored)),
    }
    return {**robots, **supports, **boxes, **panda_visual.visual_files(), **iiwa_visual.visual_files()}


def main() -> None:
    """Write all files anew."""
    FOLDER.mkdir(exist_ok=True)
    for name, text in contents().items():
        (FOLDER / name).write_text(text)


if __name__ == "__main__":
    main()
