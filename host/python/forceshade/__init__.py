"""Haptic force fields with and without force shading, from Python.

    import forceshade
    scene = forceshade.Scene({"surface": {"kind": "bump", "radius": "600 mil", "facets": 2},
                              "force": {"shading": "reference"}})
    force = scene.forces([[0.001, 0, -0.001]])     # N, at places in metres
    field = scene.field()                          # over the scene's grid

The numbers are those of the command line, digit for digit. Lengths are in metres, forces in newtons, in the scene's
precision (f32 or f64); scenes themselves carry their units as everywhere: "600 mil", "1 N/mm".
"""

from __future__ import annotations

import csv
import json
import os
import re
import time
import tomllib
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field as _field
from pathlib import Path
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._native import DeviceError, Error, FileError, SceneError, __version__

__all__ = ["Contact", "DeviceError", "Error", "Field", "FileError", "GodObject", "Paths", "Renderer", "Scene", "SceneError",
           "SceneWarning", "Table", "angle", "read", "score", "sphere", "__version__"]

Array = NDArray[Any]
FilePath = Union[str, "os.PathLike[str]"]


class SceneWarning(UserWarning):
    """A warning about a scene or its mesh."""


def angle(one: ArrayLike, other: ArrayLike) -> Array:
    """The angle between vectors, in degrees: shape (..., 3) and (..., 3) to (...). NaN where one of them is zero."""
    a, b = (np.asarray(v, dtype=float) for v in (one, other))
    with np.errstate(invalid="ignore", divide="ignore"):
        a, b = (v / np.linalg.norm(v, axis=-1, keepdims=True) for v in (a, b))
    return np.asarray(np.degrees(2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))))


@dataclass(frozen=True, repr=False)
class Contact:
    """What probes meet; the arrays have the shape of the probes' array, without its last axis for numbers.

        force: N, (..., 3); 0 out of contact.
        unshaded: N, (..., 3): what shading = "none" would give.
        depth: m, (...).
        proxy: m, (..., 3): the place of the surface that is touched; the probe itself out of contact.
        facet: (...): its number, -1 out of contact.
        angle: deg, (...): with [compare], between the force and the normal of the shape there; NaN where there is none.
        magnitude_error: N, (...): with [compare], the force's magnitude less that of the shape; NaN out of contact with
            both.
    """

    force: Array
    unshaded: Array
    depth: Array
    proxy: Array
    facet: Array
    angle: Array | None = None
    magnitude_error: Array | None = None

    def __repr__(self) -> str:
        return f"<forceshade.Contact: {_shapes(self)}>"

    @property
    def turn(self) -> Array:
        """deg, (...): by which shading turns the force; NaN out of contact."""
        return angle(self.force, self.unshaded)


def _shapes(one: Any) -> str:
    """The names of arrays that are there, with their shapes."""
    arrays = {name: getattr(one, name) for name in one.__dataclass_fields__}
    return ", ".join(f"{name} {values.shape}" for name, values in arrays.items() if isinstance(values, np.ndarray))


@dataclass(frozen=True, repr=False)
class Field:
    """Forces over a grid; sample [k, j, i] lies at (x[i], y[j], z[k]).

        x: m, (nx,).
        y: m, (ny,).
        z: m, (nz,).
        force: N, (nz, ny, nx, 3). Where the field does not depend on y, one layer that stands for all, and is read-
            only.
        depth: m, (nz, ny, nx).
        facet: (nz, ny, nx); -1 out of contact.
        proxy: m, (nz, ny, nx, 3).
        unshaded: N, (nz, ny, nx, 3).
        angle: deg, (nz, ny, nx): with [compare], between the force and the normal of the shape there; NaN without a
            force.
        magnitude_error: N, (nz, ny, nx): with [compare], the force's magnitude less that of the shape; NaN out of
            contact with both.
        scene: The scene as complete TOML.
    """

    x: Array
    y: Array
    z: Array
    force: Array
    depth: Array | None = None
    facet: Array | None = None
    proxy: Array | None = None
    unshaded: Array | None = None
    angle: Array | None = None
    magnitude_error: Array | None = None
    scene: str = ""

    def __repr__(self) -> str:
        box = ", ".join(f"{name} {1e3 * at[0]:.4g} to {1e3 * at[-1]:.4g} mm"
                        for name, at in (("x", self.x), ("y", self.y), ("z", self.z)))
        return f"<forceshade.Field: {box}; forces up to {self.magnitude.max():.4g} N; {_shapes(self)}>"

    @property
    def magnitude(self) -> Array:
        """N, (nz, ny, nx)."""
        return np.asarray(np.linalg.norm(self.force, axis=-1))

    def xarray(self) -> Any:
        """As an xarray.Dataset with coordinates in metres (package python3-xarray)."""
        import xarray
        data = {}
        for name in ("force", "depth", "facet", "proxy", "unshaded", "angle", "magnitude_error"):
            values = getattr(self, name)
            if values is not None:
                unit = {"depth": "m", "proxy": "m", "facet": "1", "angle": "deg"}.get(name, "N")
                data[name] = (("z", "y", "x", "component")[:values.ndim], values, {"units": unit})
        coordinates: dict[str, Any] = {axis: (axis, getattr(self, axis), {"units": "m"}) for axis in "xyz"}
        coordinates["component"] = list("xyz")
        return xarray.Dataset(data, coordinates, {"scene": self.scene})


@dataclass(frozen=True, repr=False)
class Paths:
    """What probes met along paths; behind the end of a shorter path stand NaN and -1.

        position: m, (paths, steps, 3): where the law was evaluated.
        force: N, (paths, steps, 3).
        proxy: m, (paths, steps, 3).
        depth: m, (paths, steps).
        facet: (paths, steps); -1 out of contact.
        angle: deg, (paths, steps): with [compare], as of a Contact.
        magnitude_error: N, (paths, steps): likewise.
        rate: Hz: samples a second; NaN for a file of recorded paths, whose samples have times of their own.
        figures: Numbers of each path, (paths,): the columns of PATHS.paths.csv, whose names carry their units.
        scene: The scene as complete TOML.
    """

    position: Array
    force: Array
    proxy: Array | None = None
    depth: Array | None = None
    facet: Array | None = None
    angle: Array | None = None
    magnitude_error: Array | None = None
    rate: float = float("nan")
    figures: Mapping[str, Array] = _field(default_factory=dict)
    scene: str = ""

    def __repr__(self) -> str:
        return f"<forceshade.Paths: {_shapes(self)}>"

    @property
    def time(self) -> Array:
        """s, (steps,)."""
        return np.arange(self.force.shape[1]) / self.rate


class Scene:
    """A scene, ready to evaluate. It never changes, and threads may share it.

    scene: its tables as in a TOML file, such as {"surface": {"kind": "bump", "facets": 2}}; `forceshade schema` lists
        all keys. File names in it are relative to the current folder.
    overrides: keys that replace those of the scene, such as {"surface.radius": "700 mil", "run.precision": "f64"}.
    mesh: (vertices (n, 3), faces (m, 3)) of a scene with surface.kind = "mesh", in place of surface.file; in metres
        unless surface.unit says otherwise. Faces of other polygons are lists of vertex numbers.

    Raises SceneError for what is wrong in it, FileError for files that it names. Warnings are SceneWarning.
    """

    def __init__(self, scene: Mapping[str, Any], overrides: Mapping[str, Any] | None = None, *,
                 mesh: tuple[ArrayLike, Any] | None = None) -> None:
        if not isinstance(scene, Mapping):
            raise SceneError(f"a scene is a dict of tables, got {scene!r}; for a file: Scene.load(...)")
        arrays = None
        if mesh is not None:
            if scene.get("surface", {}).get("kind") != "mesh":
                raise SceneError("mesh= is for scenes with {'surface': {'kind': 'mesh'}}")
            arrays = _mesh(*mesh)
            scene = {**scene, "surface": {"unit": "m", **scene.get("surface", {}), "file": "mesh"}}
        lines = _toml(scene)
        try:
            self._open("\n".join(text for text, _ in lines), "scene", ".", overrides, arrays)
        except SceneError as error: # a place in the TOML is none that the caller knows
            raise SceneError(re.sub(r"^scene:(\d+):\d+", lambda place: "scene" + lines[int(place[1]) - 1][1],
                                    str(error), flags=re.MULTILINE)) from None

    @classmethod
    def load(cls, file: FilePath, overrides: Mapping[str, Any] | None = None) -> Scene:
        """The scene in a TOML file."""
        path = Path(file)
        try:
            text = _native.read_scene_text(str(path))
        except UnicodeDecodeError as error:
            raise SceneError(f"{path}: is no text in UTF-8: {error}") from None
        return cls.parse(text, overrides, name=str(path), folder=path.parent)

    @classmethod
    def parse(cls, text: str, overrides: Mapping[str, Any] | None = None, *, name: str = "scene",
              folder: FilePath = ".") -> Scene:
        """The scene in TOML text; messages call it `name`, and its files are relative to `folder`."""
        scene = cls.__new__(cls)
        scene._open(text, name, os.fspath(folder), overrides)
        return scene

    def _open(self, text: str, name: str, folder: str, overrides: Mapping[str, Any] | None,
              mesh: tuple[Array, Array, Array] | None = None) -> None:
        given = [(key, value if isinstance(value, str) else _value(value)) for key, value in (overrides or {}).items()]
        self._native = _native.Scene(text, name, os.path.abspath(folder), given, mesh)
        for warning in self._native.warnings:
            warnings.warn(warning, SceneWarning, stacklevel=4)

    @property
    def toml(self) -> str:
        """The scene as complete TOML, defaults included."""
        return self._native.toml

    def __repr__(self) -> str:
        keys = tomllib.loads(self.toml)
        surface, force = keys["surface"], keys["force"]
        return (f"<forceshade.Scene: {surface['kind']}, shading {force['shading']}, K = {force['stiffness']}; "
                "toml has all of it>")

    def field(self, channels: Sequence[str] = (), *, engine: str = "cpu", gpu: str = "", threads: int = 0) -> Field:
        """The force at every sample of the scene's grid.

        channels: of "depth", "facet", "proxy" and "unshaded" those wanted beside the force; none: as the scene says.
        engine: "cpu", on so many threads (0: as many as there are cores), or "gpu", by name, UUID or index.
        Raises MemoryError for more than the machine has, DeviceError.
        """
        if isinstance(channels, str):
            raise SceneError(f"channels is a list of names, such as [{channels!r}]")
        arrays = self._native.field(list(channels), engine, gpu, threads)
        size = len(arrays["z"]), len(arrays["y"]), len(arrays["x"])
        for name, values in arrays.items():
            if values.ndim > 1 and values.shape[1] != size[1]:
                arrays[name] = np.broadcast_to(values, size + values.shape[3:])
        if self._native.compares:
            places = np.empty(size + (3,))
            places[..., 0] = arrays["x"]
            places[..., 1] = arrays["y"][:, None]
            places[..., 2] = arrays["z"][:, None, None]
            self._compare(arrays, places, threads)
        return Field(**arrays, scene=self.toml)

    def contact(self, points: ArrayLike, *, threads: int = 0) -> Contact:
        """What a probe meets at each point (..., 3), m, that has no history: on a mesh the nearest place of it."""
        points = np.asarray(points, dtype=float)
        arrays = self._native.contact(_rows(points), threads)
        self._compare(arrays, _rows(points), threads)
        return _contact(arrays, points.shape)

    def forces(self, points: ArrayLike, *, threads: int = 0) -> Array:
        """N, (..., 3): the force at each point (..., 3), m; as contact(points).force."""
        return self.contact(points, threads=threads).force

    def explore(self, paths: Array | Sequence[ArrayLike] | None = None, *, engine: str = "cpu", gpu: str = "",
                threads: int = 0) -> Paths:
        """Takes probes along paths, each with its own history.

        paths: positions in metres, (paths, steps, 3), or a list of arrays (steps, 3), a sample each 1/rate s; in a
            closed loop where the hand wants to be. None: as the scene's [paths] says.
        """
        if isinstance(paths, np.ndarray) and paths.ndim == 2:
            raise SceneError(f"paths have shape (paths, steps, 3), got {paths.shape}; one path alone is paths[None]")
        given = None if paths is None else [_rows(np.asarray(path, dtype=float)) for path in paths]
        arrays = self._native.explore(given, engine, gpu, threads)
        if self._native.compares:
            there = np.isfinite(arrays["position"])
            self._compare(arrays, np.where(there, arrays["position"], 0), threads)
            for name in ("angle", "magnitude_error"):
                arrays[name][~there[..., 0]] = np.nan
        return Paths(**arrays, scene=self.toml)

    def _compare(self, arrays: dict[str, Any], places: Array, threads: int) -> None:
        """Adds angle and magnitude_error, of the shape of places without its last axis, if there is [compare]."""
        if self._native.compares:
            found = self._native.compare(places.reshape(-1, 3), arrays["force"].reshape(-1, 3), threads)
            arrays.update({name: values.reshape(places.shape[:-1]) for name, values in found.items()})


class GodObject:
    """A probe with a history, as the live loop has it: on a mesh its proxy stays on the side where it began."""

    def __init__(self, scene: Scene) -> None:
        self._native = _native.GodObject(scene._native)
        self._scene = scene

    def __repr__(self) -> str:
        return f"<forceshade.GodObject on {self._scene!r}>"

    def step(self, point: ArrayLike) -> Contact:
        """The contact of the probe at its next place (3,), m."""
        return self.follow(point)

    def follow(self, points: ArrayLike) -> Contact:
        """The contacts along a way (n, 3), m; goes on from where the last one ended."""
        places = np.asarray(points, dtype=float)
        arrays = self._native.follow(_rows(places))
        self._scene._compare(arrays, _rows(places), 1)
        return _contact(arrays, places.shape)

    def reset(self) -> None:
        """Forgets the past: the next place begins a new way."""
        self._native.reset()


class Renderer:
    """A haptic renderer of one's own, to be scored: override update, and reset if it has a history."""

    def reset(self) -> None:
        """The next update begins a stroke."""

    def update(self, probe: Array) -> ArrayLike:
        """The force (3,), N, on the probe at its next place (3,), m."""
        raise NotImplementedError


def score(scene: Scene, strokes: Sequence[ArrayLike], renderers: Mapping[str, Renderer | Sequence[ArrayLike]],
          rate: float = 1000) -> dict[str, Table]:
    """Holds renderers against the oracle along strokes: positions (n, 3), m, a sample each 1 / rate, Hz. A renderer is a
    Renderer, or forces (n, 3), N, for each stroke. For each a Table with a row a stroke: the measures of
    `forceshade score` (host/score/README.md), with their units, and for a Renderer `update_us`, the median time of an
    update. The oracle's own row comes first. What a renderer raises is its caller's."""
    places = [np.asarray(stroke, dtype=float) for stroke in strokes]
    native = _native.ScoredStrokes(scene._native, places, rate)
    scores = {"oracle": Table(native.score(native.oracle()))}
    for name, renderer in renderers.items():
        if name == "oracle":
            raise ValueError('a renderer is called "oracle", as the oracle itself; give it another name')
        times = None
        forces: list[Array] = []
        if not isinstance(renderer, Renderer):
            forces = [np.asarray(one, dtype=float) for one in renderer]
        else:
            times = []
            for stroke in places:
                renderer.reset()
                own, seconds = np.empty_like(stroke), np.empty(len(stroke))
                for i, probe in enumerate(stroke):
                    start = time.perf_counter()
                    force = np.asarray(renderer.update(probe.copy()), dtype=float)
                    seconds[i] = time.perf_counter() - start
                    if force.shape != (3,):
                        raise ValueError(f"{name}.update returned an array of shape {force.shape}; expected a force "
                                         "(3,), N")
                    own[i] = force
                forces.append(own)
                times.append(1e6 * np.median(seconds))
        columns = native.score(forces)
        scores[name] = Table(columns if times is None else {**columns, "update_us": np.asarray(times)})
    return scores


def read(file: FilePath) -> Field | Paths | Table:
    """What the program wrote: FIELD.exr as Field, PATHS.exr as Paths, a .csv file or a sweep's folder (its summary.csv,
    a row a case) as Table."""
    path = Path(file)
    if path.is_dir():
        return _table(path / "summary.csv")
    if path.suffix.lower() not in (".exr", ".csv"):
        raise FileError(f"{path}: read takes .exr and .csv files that forceshade wrote, or the folder of a sweep")
    if path.suffix.lower() == ".csv":
        return _table(path)
    arrays = _native.read_exr(os.fspath(path))
    return Field(**arrays) if "x" in arrays else Paths(**arrays)


class Table(Mapping[str, Array]):
    """Columns by name, as arrays: numbers where all cells are some (NaN where one is empty), else texts."""

    def __init__(self, columns: Mapping[str, Array]) -> None:
        self._columns = dict(columns)

    def __getitem__(self, name: str) -> Array:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()), ()))
        return f"<forceshade.Table of {rows} rows: {', '.join(self)}>"

    def pandas(self) -> Any:
        """As a pandas.DataFrame (package python3-pandas)."""
        import pandas  # type: ignore[import]
        return pandas.DataFrame(self._columns)


def sphere(radius: float, subdivisions: int) -> tuple[Array, Array]:
    """A mesh inscribed in a sphere: the icosahedron, each triangle split into subdivisions**2 of nearly equal size.

    Returns vertices (n, 3), in the unit of radius, and faces (20 * subdivisions**2, 3).
    """
    if subdivisions < 1:
        raise ValueError(f"subdivisions is 1 or more, got {subdivisions}")
    if isinstance(radius, str) or not radius > 0:
        raise ValueError(f"radius is a positive number, got {radius!r}")
    golden = (1 + 5 ** 0.5) / 2
    pairs = [(-1, golden), (1, golden), (-1, -golden), (1, -golden)]
    corners = np.array([(a, b, 0) for a, b in pairs] + [(0, a, b) for a, b in pairs] + [(b, 0, a) for a, b in pairs])
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                 (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
                 (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    n = subdivisions
    numbers: dict[tuple[tuple[int, int], ...], int] = {}
    points: list[Array] = []
    faces = []

    def vertex(triangle: tuple[int, int, int], i: int, j: int) -> int:
        # Corners and their weights, so that triangles share the vertices of an edge.
        key = tuple(sorted((c, w) for c, w in zip(triangle, (n - i - j, i, j)) if w))
        if key not in numbers:
            numbers[key] = len(points)
            points.append(sum(w * corners[c] for c, w in key))
        return numbers[key]

    for triangle in triangles:
        for i in range(n):
            for j in range(n - i):
                faces.append([vertex(triangle, i, j), vertex(triangle, i + 1, j), vertex(triangle, i, j + 1)])
                if i + j < n - 1:
                    faces.append([vertex(triangle, i + 1, j), vertex(triangle, i + 1, j + 1),
                                  vertex(triangle, i, j + 1)])
    vertices = np.array(points)
    return radius * vertices / np.linalg.norm(vertices, axis=1, keepdims=True), np.array(faces)


def _rows(points: Array) -> Array:
    if points.ndim == 0 or points.shape[-1] != 3:
        raise SceneError(f"points have three coordinates, in metres, along their last axis; got shape {points.shape}")
    return points.reshape(-1, 3)


def _contact(arrays: Mapping[str, Array], shape: tuple[int, ...]) -> Contact:
    return Contact(**{name: values.reshape(shape[:-1] + values.shape[1:]) for name, values in arrays.items()})


def _value(value: Any) -> str:
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, Sequence):
        return "[" + ", ".join(map(_value, value)) + "]"
    raise SceneError(f"{value!r} has no place in a scene: there are numbers, texts, lists and tables")


def _key(key: Any) -> str:
    return json.dumps(str(key), ensure_ascii=False)


def _toml(scene: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Lines, and where in the scene what stands there is."""
    lines = []
    for name, table in scene.items():
        if not isinstance(table, Mapping):
            raise SceneError(f"{name} = {table!r}: a scene has tables, such as {{'surface': {{'kind': 'bump'}}}}")
        lines.append((f"[{_key(name)}]", f"[{name!r}]"))
        lines += [(f"{_key(key)} = {_value(value)}", f"[{name!r}][{key!r}]") for key, value in table.items()]
    return lines or [("", "")]


def _mesh(vertices: ArrayLike, faces: Any) -> tuple[Array, Array, Array]:
    """Vertices, all faces' corners, and the number of corners of each face."""
    points = np.asarray(vertices, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise SceneError(f"the mesh's vertices have shape (n, 3), got {points.shape}")
    lists = [np.asarray(face) for face in faces]
    for number, face in enumerate(lists):
        if face.ndim != 1 or (face.size and face.dtype.kind not in "iu"):
            raise SceneError(f"faces[{number}] = {face.tolist()}: a face is a list of vertex numbers")
    counts = np.array([len(face) for face in lists], dtype=np.int64)
    return points, np.concatenate(lists or [counts]).astype(np.int64), counts


def _table(path: Path) -> Table:
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            rows = csv.reader(file)
            names: list[str] = next(rows, [])
            try: # quick, where all cells are numbers
                numbers = np.loadtxt(file, delimiter=",", ndmin=2)
                return Table(dict(zip(names, numbers.T)) if len(numbers) else {name: numbers for name in names})
            except ValueError:
                file.seek(0)
                cells = list(rows)[1:]
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror}") from None
    columns = {}
    for i, name in enumerate(names):
        texts = [row[i] for row in cells]
        try:
            columns[name] = np.array([float(text) if text else np.nan for text in texts])
        except ValueError:
            columns[name] = np.array(texts)
    return Table(columns)
