"""Robot files and models that change while a program runs."""

import os
from pathlib import Path

import pytest

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.robots.robot import find_robot
from tests.robots import small


def test_a_robot_whose_files_have_not_changed_is_built_once(tmp_path: Path) -> None:
    file = str(small.write(tmp_path))
    assert find_robot(file) is find_robot(file)


def test_a_model_that_changes_is_read_again(tmp_path: Path) -> None:
    file, model = small.write(tmp_path), tmp_path / "small.urdf"
    before = find_robot(str(file))
    assert set(before.velocity) == {2.0}
    stamp = model.stat().st_mtime_ns
    model.write_text(small.urdf().replace('velocity="2"', 'velocity="3"'), encoding="utf-8")
    os.utime(model, ns=(stamp, stamp + 1))
    after = find_robot(str(file))
    assert set(after.velocity) == {3.0}
    assert set(before.velocity) == {2.0}


def test_a_relative_path_is_that_of_the_folder_where_the_program_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = []
    for name, velocity in (("one", "2"), ("other", "3")):
        folder = tmp_path / name
        folder.mkdir()
        file = small.write(folder, model=small.urdf().replace('velocity="2"', f'velocity="{velocity}"'))
        monkeypatch.chdir(folder)
        found.append(find_robot(file.name).velocity[0])
    assert found == [2.0, 3.0]


def test_a_model_that_disappears_is_refused(tmp_path: Path) -> None:
    file = small.write(tmp_path)
    find_robot(str(file))
    (tmp_path / "small.urdf").unlink()
    with pytest.raises(IctampError) as caught:
        find_robot(str(file))
    assert caught.value.code is Code.NOT_READABLE


@pytest.mark.parametrize("quote", ['"', "'"])
def test_meshes_are_found_beside_the_model(tmp_path: Path, quote: str) -> None:
    folder = tmp_path / "my meshes"
    folder.mkdir()
    corners = ((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1))
    faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (folder / "base.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) + faces)
    mesh = f"<mesh filename={quote}my meshes/base.obj{quote}/>"
    model = small.urdf().replace('<box size="0.12 0.12 0.08"/>', mesh)
    assert find_robot(str(small.write(tmp_path, model=model))).touching == ()
