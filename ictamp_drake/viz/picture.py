"""scene.png: a picture of a configuration, drawn without a graphics card."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from pydrake.geometry import (
    Box,
    Capsule,
    Cylinder,
    GeometryId,
    GeometrySet,
    Mesh,
    QueryObject,
    Rgba,
    Role,
    Shape,
    Sphere,
)

from ictamp_drake.core.files import whole
from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.models.package import PACKAGE_FILE
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.viz.marks import add_caption, mark
from ictamp_drake.viz.raster import Camera, render, silhouette
from ictamp_drake.viz.reasons import NO_REASONS, Reasons
from ictamp_drake.viz.stage import BACKGROUND, FIELD_OF_VIEW, Stage, viewpoint
from ictamp_drake.viz.triangles import box, capsule, cylinder, polygons, read_gltf

WIDTH, HEIGHT = 800, 600
FOLDER = PACKAGE_FILE.parent
"""Folder of the meshes of the package."""
GRAY = Rgba(0.6, 0.6, 0.62)
"""Color of a mesh that has none."""


def scene_png(
    spec: SceneSpec, c: Configuration, path: Path, stage: Stage | None = None, reasons: Reasons = NO_REASONS
) -> None:
    """Write a picture of c; it appears whole or not at all.

    Args:
        spec: Scene to show.
        c: Configuration to show.
        path: File of the picture.
        stage: Stage whose bodies are drawn; by default a new one.
        reasons: Reasons why there is no plan; refused actions and obstacles are marked, and listed below the picture.
    """
    stage = stage or Stage(spec)
    image = Image.fromarray(picture(spec, c, stage))
    if reasons.ended:
        image = mark(image, _silhouettes(spec, c, stage, reasons.colors), reasons.colors)
        image = add_caption(image, reasons)
    with whole(path) as temporary:
        image.save(temporary, format="png")


def picture(spec: SceneSpec, c: Configuration, stage: Stage | None = None) -> np.ndarray:
    """The scene as it looks in c, shape (HEIGHT, WIDTH, 3), 0 to 255."""
    query = (stage or Stage(spec)).shapes(c)
    parts = [_part(query, geometry) for geometry in _visible(query)]
    triangles, colors = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return render(triangles, colors, _camera(spec), np.array(BACKGROUND))


def _silhouettes(spec: SceneSpec, c: Configuration, stage: Stage, names: Iterable[str]) -> dict[str, NDArray[np.bool_]]:
    """Silhouettes of these boxes and supports in the picture, as if nothing else were there."""
    query = stage.shapes(c)
    parts: dict[str, list[FloatArray]] = {name: [] for name in names}
    for geometry in _visible(query):
        inspector = query.inspector()
        model = inspector.GetName(inspector.GetFrameId(geometry)).partition("::")[0]
        if model in parts:
            parts[model].append(_part(query, geometry)[0])
    camera = _camera(spec)
    return {name: silhouette(np.concatenate(shapes), camera) for name, shapes in parts.items() if shapes}


def _visible(query: QueryObject) -> list[GeometryId]:
    inspector = query.inspector()
    visible = inspector.GetGeometryIds(GeometrySet(inspector.GetAllGeometryIds()), Role.kIllustration)
    return sorted(visible, key=GeometryId.get_value)


def _camera(spec: SceneSpec) -> Camera:
    return Camera(*viewpoint(spec), np.deg2rad(FIELD_OF_VIEW), WIDTH, HEIGHT)


def _part(query: QueryObject, geometry: GeometryId) -> tuple[FloatArray, FloatArray]:
    """Triangles in W and their colours."""
    inspector = query.inspector()
    triangles, color = _triangles(inspector.GetShape(geometry))
    if color is None:
        properties = inspector.GetIllustrationProperties(geometry)
        has_color = properties.HasProperty("phong", "diffuse")
        rgba = properties.GetProperty("phong", "diffuse") if has_color else GRAY
        color = np.array([rgba.r(), rgba.g(), rgba.b()])
    X_WG = query.GetPoseInWorld(geometry)
    in_world = triangles @ X_WG.rotation().matrix().T + X_WG.translation()
    return in_world, np.broadcast_to(color, (len(triangles), 3))


def _triangles(shape: Shape) -> tuple[FloatArray, FloatArray | None]:
    """Triangles in the shape's frame, and their colour where the shape brings one."""
    match shape:
        case Mesh():
            return _read_mesh(shape)
        case Box():
            return box(shape.size()), None
        case Sphere():
            return capsule(shape.radius(), 0.0), None
        case Cylinder():
            return cylinder(shape.radius(), shape.length()), None
        case Capsule():
            return capsule(shape.radius(), shape.length()), None
    raise TypeError(f"cannot draw {shape}")


def _read_mesh(mesh: Mesh) -> tuple[FloatArray, FloatArray | None]:
    """Triangles and colour of a mesh of the package, or the convex hull of another one, if Drake can read it."""
    path = mesh.source().path()
    if FOLDER in path.parents:
        return read_gltf(path)
    try:
        hull = mesh.GetConvexHull()
    except RuntimeError:
        return np.empty((0, 3, 3)), None
    faces = (hull.element(number) for number in range(hull.num_faces()))
    corners = [[hull.vertex(face.vertex(i)) for i in range(face.num_vertices())] for face in faces]
    return polygons(list(map(np.array, corners))), None
