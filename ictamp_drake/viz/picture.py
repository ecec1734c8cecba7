"""scene.png: a picture of a configuration, drawn without a graphics card."""

from pathlib import Path

import numpy as np
from PIL import Image
from pydrake.geometry import Box, Capsule, Cylinder, GeometryId, GeometrySet, Mesh, QueryObject, Role, Shape, Sphere

from ictamp_drake.core.files import whole
from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.viz.raster import Camera, render
from ictamp_drake.viz.stage import BACKGROUND, FIELD_OF_VIEW, Stage, viewpoint
from ictamp_drake.viz.triangles import box, capsule, cylinder, read_gltf

WIDTH, HEIGHT = 800, 600


def scene_png(spec: SceneSpec, c: Configuration, path: Path, stage: Stage | None = None) -> None:
    """Write a picture of c, of the bodies of the stage if there is one; it appears whole or not at all."""
    with whole(path) as temporary:
        Image.fromarray(picture(spec, c, stage)).save(temporary, format="png")


def picture(spec: SceneSpec, c: Configuration, stage: Stage | None = None) -> np.ndarray:
    """The scene as it looks in c, shape (HEIGHT, WIDTH, 3), 0 to 255."""
    stage = stage or Stage(spec)
    query = stage.shapes(c)
    inspector = query.inspector()
    visible = inspector.GetGeometryIds(GeometrySet(inspector.GetAllGeometryIds()), Role.kIllustration)
    parts = [_part(query, geometry) for geometry in sorted(visible, key=GeometryId.get_value)]
    camera = Camera(*viewpoint(spec), np.deg2rad(FIELD_OF_VIEW), WIDTH, HEIGHT)
    triangles, colors = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return render(triangles, colors, camera, np.array(BACKGROUND))


def _part(query: QueryObject, geometry: GeometryId) -> tuple[FloatArray, FloatArray]:
    """Triangles in W and their colours."""
    inspector = query.inspector()
    triangles, color = _triangles(inspector.GetShape(geometry))
    if color is None:
        rgba = inspector.GetIllustrationProperties(geometry).GetProperty("phong", "diffuse")
        color = np.array([rgba.r(), rgba.g(), rgba.b()])
    X_WG = query.GetPoseInWorld(geometry)
    in_world = triangles @ X_WG.rotation().matrix().T + X_WG.translation()
    return in_world, np.broadcast_to(color, (len(triangles), 3))


def _triangles(shape: Shape) -> tuple[FloatArray, FloatArray | None]:
    """Triangles in the shape's frame, and their colour where the shape brings one."""
    match shape:
        case Mesh():
            return read_gltf(shape.source().path())
        case Box():
            return box(shape.size()), None
        case Sphere():
            return capsule(shape.radius(), 0.0), None
        case Cylinder():
            return cylinder(shape.radius(), shape.length()), None
        case Capsule():
            return capsule(shape.radius(), shape.length()), None
    raise TypeError(f"cannot draw {shape}")
