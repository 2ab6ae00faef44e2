"""The Python module against the program: the same bits, the same words, arrays as NumPy has them."""

import gc
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np

import forceshade

PROGRAM, SOURCE = sys.argv.pop(1), sys.argv.pop(1)
CHANNELS = ("force", "depth", "facet", "proxy", "unshaded")
BUMP = {"surface": {"kind": "bump", "radius": "600 mil", "facets": 3}, "force": {"shading": "reference"},
        "grid": {"size": [40, 6, 30], "origin": ["-20 mm", "-1 mm", "-8 mm"], "spacing": "1 mm"}}
SPOT = {"surface": {"kind": "mesh", "file": SOURCE + "/tests/data/spot.obj", "unit": "mm", "transform": {"scale": 40}},
        "force": {"shading": "mean_value"}, "grid": {"samples": 24}}


def grid_of(field):
    """(nz, ny, nx, 3), m: where the samples are."""
    z, y, x = np.meshgrid(field.z, field.y, field.x, indexing="ij")
    return np.stack([x, y, z], -1)


class InFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write_scene(self, scene, name="scene.toml", extra=""):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(forceshade.Scene(scene).toml.replace("spot.obj", SOURCE + "/tests/data/spot.obj") + extra)
        return self.path(name)

    def program(self, *arguments):
        done = subprocess.run([PROGRAM, *arguments, "--quiet"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)


class SameBits(InFolder):
    def test_reprs_are_one_line(self):
        scene = forceshade.Scene({"surface": {"kind": "bump", "facets": 2}, "grid": {"size": [9, 3, 5], "spacing": "5 mm"}})
        for one in (scene.field(["depth"]), scene.contact([[0, 0, -1e-3]])):
            self.assertNotIn("\n", repr(one))
            self.assertIn("force (", repr(one))
        self.assertEqual(repr(scene), "<forceshade.Scene: bump, shading none, K = 1 N/mm; toml has all of it>")
        self.assertIn("bump", repr(forceshade.GodObject(scene)))
        with self.assertRaisesRegex(forceshade.SceneError, "list of names"):
            scene.field("depth")

    def test_fields_are_those_of_the_command_line(self):
        for scene in (BUMP, SPOT):
            for precision in ("f32", "f64"):
                with self.subTest(kind=scene["surface"]["kind"], precision=precision):
                    scene = {**scene, "run": {"precision": precision}, "output": {"channels": list(CHANNELS)}}
                    out = self.path(f"{scene['surface']['kind']}-{precision}.exr")
                    self.program("field", self.write_scene(scene), "--out", out, "--also", "npy")
                    field = forceshade.Scene(scene).field()
                    for name in CHANNELS:
                        expected = np.load(out.replace(".exr", f".{name}.npy"))
                        np.testing.assert_array_equal(getattr(field, name), expected.astype(getattr(field, name).dtype))
                    self.assertGreater(field.magnitude.max(), 0)

    def test_places_and_engines_give_what_the_grid_gives(self):
        for scene in (BUMP, SPOT, {**SPOT, "surface": {**SPOT["surface"], "inside": "winding"}}):
            for precision in ("f32", "f64"):
                loaded = forceshade.Scene(scene, {"run.precision": precision})
                field, device = loaded.field(CHANNELS), loaded.field(CHANNELS, engine="gpu")
                contact = loaded.contact(grid_of(field))
                self.assertEqual(contact.force.dtype, np.float32 if precision == "f32" else np.float64)
                for name in CHANNELS:
                    np.testing.assert_array_equal(getattr(contact, name), getattr(field, name))
                    if precision == "f32":
                        np.testing.assert_array_equal(getattr(device, name), getattr(field, name))
                np.testing.assert_array_equal(loaded.forces(grid_of(field), threads=1), field.force)

    def test_paths_and_single_steps_are_those_of_the_command_line(self):
        random = np.random.default_rng(3)
        ways = np.cumsum(random.normal(0, 0.0006, (4, 60, 3)), axis=1)
        for scene in (BUMP, SPOT):
            loaded = forceshade.Scene(scene, {"run.precision": "f64"})
            with open(self.path("ways.csv"), "w", encoding="ascii") as file:
                file.write("path,t,x,y,z\n")
                for path, way in enumerate(ways.tolist()):
                    file.writelines(f"{path},{i * 1e-3!r},{x!r},{y!r},{z!r}\n" for i, (x, y, z) in enumerate(way))
            self.program("explore", self.write_scene({**scene, "run": {"precision": "f64"}}), "--paths",
                         self.path("ways.csv"), "--out", self.path(scene["surface"]["kind"] + ".csv"))
            table = forceshade.read(self.path(scene["surface"]["kind"] + ".csv"))
            explored = loaded.explore(ways)
            self.assertGreater(np.abs(explored.force).max(), 0)
            for name, columns in {"position": "x y z", "force": "fx fy fz", "proxy": "gx gy gz"}.items():
                expected = np.stack([table[column] for column in columns.split()], -1).reshape(ways.shape)
                np.testing.assert_array_equal(getattr(explored, name), expected)
            np.testing.assert_array_equal(explored.facet.ravel(), table["facet"])
            figures = forceshade.read(self.path(scene["surface"]["kind"] + ".paths.csv"))
            for name in ("largest_force_N", "work_J", "mean_depth_m"):
                np.testing.assert_array_equal(explored.figures[name], figures[name])
            for path, way in enumerate(ways):
                probe = forceshade.GodObject(loaded)
                np.testing.assert_array_equal(probe.follow(way).force, explored.force[path])
                probe.reset()
                np.testing.assert_array_equal([probe.step(place).force for place in way], explored.force[path])

    def test_shorter_paths_end_in_nan(self):
        explored = forceshade.Scene(BUMP).explore([np.zeros((3, 3)), np.full((5, 3), -0.001)])
        self.assertEqual(explored.force.shape, (2, 5, 3))
        self.assertTrue(np.isnan(explored.force[0, 3:]).all() and np.isfinite(explored.force[0, :3]).all())
        self.assertTrue((explored.facet[0, 3:] == -1).all())
        np.testing.assert_array_equal(explored.figures["steps"], [3, 5])

    def test_the_scenes_own_paths_are_those_of_the_command_line(self):
        paths = {"kind": "strokes", "count": 5, "steps": 40, "depth": "1 mm", "seed": 7}
        scene = {key: value for key, value in BUMP.items() if key != "grid"} | {"paths": paths}
        self.program("explore", self.write_scene(scene), "--out", self.path("p.exr"))
        read, explored = forceshade.read(self.path("p.exr")), forceshade.Scene(scene).explore()
        np.testing.assert_array_equal(read.force, explored.force)
        np.testing.assert_array_equal(read.position, explored.position)
        self.assertEqual((read.rate, explored.rate), (1000, 1000))
        with self.assertRaisesRegex(forceshade.SceneError, "no \\[grid\\]"):
            forceshade.Scene(scene).field()


class Comparing(InFolder):
    """Against shapes that NumPy computes by itself."""

    SPHERE = {"surface": {"kind": "sphere", "radius": "20 mm", "centre": ["0 mm", "0 mm", "-3 mm"]}}

    def expected(self, places, force, away, depth, stiffness=1000):
        size = np.linalg.norm(force, axis=-1)
        touched = (size > 0) | (depth > 0)
        error = np.where(touched, size - stiffness * np.maximum(depth, 0), np.nan)
        return forceshade.angle(force, away), error

    def check(self, got, angle, error):
        np.testing.assert_allclose(got.angle, angle, atol=2e-5)
        np.testing.assert_allclose(got.magnitude_error, error, atol=2e-6)
        self.assertGreater(np.isfinite(got.angle).sum(), 10)

    def test_a_sphere_under_a_polyhedron_and_a_bump(self):
        vertices, faces = forceshade.sphere(0.02, 3)
        mesh = (vertices + [0, 0, -0.003], faces)
        scenes = [forceshade.Scene({"surface": {"kind": "mesh"}, "grid": {"samples": 20}, "compare": self.SPHERE,
                                    "run": {"precision": "f64"}}, mesh=mesh),
                  forceshade.Scene({**BUMP, "compare": self.SPHERE, "run": {"precision": "f64"}})] # y on its own
        for scene in scenes:
            field = scene.field()
            from_centre = grid_of(field) - [0, 0, -0.003]
            distance = np.linalg.norm(from_centre, axis=-1)
            self.check(field, *self.expected(grid_of(field), field.force, from_centre, 0.02 - distance))
            contact = scene.contact(grid_of(field))
            np.testing.assert_array_equal(contact.angle, field.angle)
        self.assertGreater(np.nanmax(scenes[0].field().angle), 5)

    def test_planes_and_cylinders(self):
        scene = forceshade.Scene({**BUMP, "compare": {"surface": {"kind": "plane", "axis": "x",
                                                                  "centre": ["2 mm", "0 mm", "0 mm"]}}},
                                 {"run.precision": "f64"})
        field, places = scene.field(), grid_of(scene.field())
        self.check(field, *self.expected(places, field.force, np.array([1.0, 0, 0]), 0.002 - places[..., 0]))
        centre = np.array([0.001, 0, -0.012])
        scene = forceshade.Scene({**BUMP, "compare": {"surface": {
            "kind": "cylinder", "radius": "14 mm", "centre": [f"{1000 * x} mm" for x in centre]}}}, {"run.precision": "f64"})
        field, away = scene.field(), (places - centre) * [1, 0, 1]
        self.check(field, *self.expected(places, field.force, away, 0.014 - np.linalg.norm(away, axis=-1)))

    def test_a_shaded_bump_has_the_direction_of_its_own_smooth_shape(self):
        scene = {**BUMP, "compare": {"surface": {"kind": "cylinder"}}, "run": {"precision": "f64"}}
        radius, half = 0.6 * 0.0254, 0.5 * 0.0254
        for shading in ("reference", "none"):
            field = forceshade.Scene(scene, {"force.shading": shading}).field()
            x = np.clip(grid_of(field)[..., 0], -half, half)
            height = np.sqrt(radius ** 2 - x ** 2) - np.sqrt(radius ** 2 - half ** 2)
            turned = np.where(np.abs(x) < half, x / radius, 0)
            normal = np.stack([turned, 0 * x, np.sqrt(1 - turned ** 2)], -1)
            self.check(field, *self.expected(grid_of(field), field.force, normal, height - grid_of(field)[..., 2]))
            largest = np.nanmax(field.angle)
            self.assertTrue(largest < 1e-5 if shading == "reference" else largest > 10)

    def test_a_finer_mesh_is_nearly_the_sphere(self):
        coarse, (vertices, faces) = forceshade.sphere(0.02, 2), forceshade.sphere(0.02, 24)
        with open(self.path("fine.obj"), "w", encoding="ascii") as file:
            file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in (1000 * vertices).tolist())
            file.writelines("f " + " ".join(str(corner + 1) for corner in face) + "\n" for face in faces)
        of_mesh, of_sphere = (forceshade.Scene({"surface": {"kind": "mesh"}, "grid": {"samples": 16}, "compare": {
            "surface": surface}}, mesh=coarse).field() for surface in
            ({"kind": "mesh", "file": self.path("fine.obj"), "unit": "mm"}, {"kind": "sphere", "radius": "20 mm"}))
        near = np.isfinite(of_sphere.angle)
        self.assertGreater(near.sum(), 500)
        np.testing.assert_allclose(of_mesh.angle[near], of_sphere.angle[near], atol=2.5)
        both = np.isfinite(of_sphere.magnitude_error) & np.isfinite(of_mesh.magnitude_error)
        np.testing.assert_allclose(of_mesh.magnitude_error[both], of_sphere.magnitude_error[both], atol=0.03)

    def test_files_have_the_same_numbers(self):
        strokes = {"kind": "strokes", "count": 4, "steps": 60, "depth": "1 mm"}
        sphere = {"kind": "sphere", "radius": "20 mm", "centre": ["0 mm", "0 mm", "-20 mm"]}
        scene = {**BUMP, "compare": {"surface": sphere, "depth": "2.05 mm"}, "paths": strokes} # no sample just there
        out = self.path("c.exr")
        self.program("field", self.write_scene(scene), "--out", out, "--also", "npy,vti")
        field, read = forceshade.Scene(scene).field(), forceshade.read(out)
        for name in ("angle", "magnitude_error"):
            np.testing.assert_array_equal(np.load(self.path(f"c.{name}.npy")), getattr(field, name))
            np.testing.assert_array_equal(getattr(read, name), getattr(field, name))
        explored = forceshade.Scene(scene).explore()
        for name in ("p.exr", "q.csv"):
            self.program("explore", self.path("scene.toml"), "--out", self.path(name))
            table = forceshade.read(self.path(name))
            angle = table["angle"].reshape(4, 60) if name == "q.csv" else table.angle
            np.testing.assert_array_equal(angle.astype(np.float32), explored.angle)
        self.program("sweep", self.write_scene(scene, "s.toml"), "--out", self.path("swept"))
        row = forceshade.read(self.path("swept"))
        for of, column in ((field, "compare"), (explored, "path_compare")):
            places = grid_of(field) if of is field else explored.position
            size = np.linalg.norm(of.force, axis=-1)
            depth = 0.02 - np.linalg.norm(places - [0, 0, -0.02], axis=-1)
            near = np.where(size > 0, size / 1000, depth) <= 0.00205
            rms = np.sqrt(np.nanmean(np.square(of.angle[near], dtype=float)))
            np.testing.assert_allclose(row[column + "_rms_angle_deg"], rms, rtol=1e-5)
            np.testing.assert_allclose(row[column + "_largest_magnitude_error_N"],
                                       np.nanmax(np.abs(of.magnitude_error[near])), rtol=1e-5)

    def test_shapes_that_say_too_little_are_refused(self):
        for surface, words in (({"kind": "sphere"}, "needs a radius"), ({"kind": "mesh"}, "needs a file"),
                               ({"kind": "spher"}, "did you mean \"sphere\""),
                               ({"kind": "plane", "radius": "1 mm"}, "does not apply to kind \"plane\""),
                               ({"kind": "sphere", "raduis": "1 mm"}, "did you mean \"surface.radius\"")):
            with self.subTest(surface=surface), self.assertRaisesRegex(forceshade.SceneError, words):
                forceshade.Scene({"surface": {"kind": "bump"}, "compare": {"surface": surface}})


class Reading(InFolder):
    def test_reads_fields_and_sweeps(self):
        scene = {**BUMP, "output": {"channels": list(CHANNELS)}}
        self.program("field", self.write_scene(scene), "--out", self.path("b.exr"))
        read, field = forceshade.read(self.path("b.exr")), forceshade.Scene(scene).field()
        for name in CHANNELS + tuple("xyz"):
            np.testing.assert_array_equal(getattr(read, name), getattr(field, name))
        self.assertEqual(read.scene, field.scene)
        study = self.write_scene(BUMP, "study.toml").replace("study.toml", "axes.toml")
        with open(self.path("study.toml"), encoding="utf-8") as file, open(study, "w", encoding="utf-8") as axes:
            axes.write(file.read().replace("facets = 3", "facets = [1, 2, 4]"))
        self.program("sweep", study, "--out", self.path("sweep"))
        table = forceshade.read(self.path("sweep"))
        self.assertEqual(len(table["case"]), 3)
        self.assertEqual(table["case"].dtype.kind, "U")
        self.assertEqual(sorted(table["facets"]), [1, 2, 4])

    def test_what_cannot_be_read_is_an_error_with_words(self):
        with open(self.path("broken.exr"), "wb") as file:
            file.write(b"v/1\x01" + bytes(50))
        for name in ("none.exr", "none.csv", "broken.exr"):
            with self.subTest(name=name), self.assertRaisesRegex(forceshade.FileError, name):
                forceshade.read(self.path(name))
        with self.assertRaises(OSError):
            forceshade.read(self.path("none.exr"))


class Scenes(InFolder):
    def test_errors_are_those_of_the_command_line_at_the_callers_place(self):
        with self.assertRaises(forceshade.SceneError) as caught:
            forceshade.Scene({"surface": {"kind": "bump", "radius": 600}})
        self.assertIn("scene['surface']['radius']: radius needs a unit", str(caught.exception))
        self.assertIsInstance(caught.exception, ValueError)
        with open(self.path("bad.toml"), "w", encoding="utf-8") as file:
            file.write('[surface]\nkind = "bumb"\n')
        with self.assertRaisesRegex(forceshade.SceneError, "bad.toml:2:8: .*did you mean \"bump\""):
            forceshade.Scene.load(self.path("bad.toml"))
        with self.assertRaisesRegex(forceshade.FileError, "bed.toml: No such file .*; did you mean .*bad.toml"):
            forceshade.Scene.load(self.path("bed.toml"))
        with self.assertRaisesRegex(forceshade.SceneError, "no channel \"forces\""):
            forceshade.Scene(BUMP).field(["forces"])
        with self.assertRaisesRegex(forceshade.DeviceError, "nothing of that name|no.*device"):
            forceshade.Scene(BUMP).field(engine="gpu", gpu="nothing of that name")

    def test_bad_points_are_refused(self):
        scene = forceshade.Scene(BUMP)
        for points in ([0, 0], [[0, 0, np.nan]], [[0, 0, np.inf]], 3, [[0, 0, 1e30]]):
            with self.subTest(points=points), self.assertRaises(forceshade.SceneError):
                scene.forces(points)
        for paths in ([], [np.zeros((0, 3))], [np.zeros((3, 2))], [np.full((3, 3), np.nan)]):
            with self.subTest(paths=paths), self.assertRaises(forceshade.SceneError):
                scene.explore(paths)
        self.assertEqual(scene.forces(np.zeros((0, 3))).shape, (0, 3))
        self.assertEqual(scene.forces([0, 0, -0.001]).shape, (3,))

    def test_a_field_beyond_the_memory_is_refused(self):
        huge = {**SPOT, "grid": {"samples": 20000}}
        with self.assertRaisesRegex(MemoryError, "this machine has"):
            forceshade.Scene(huge).field()

    def test_meshes_from_arrays_and_overrides(self):
        vertices, faces = forceshade.sphere(0.02, 3)
        np.testing.assert_allclose(np.linalg.norm(vertices, axis=1), 0.02)
        self.assertEqual(len(vertices) - len(faces) * 3 // 2 + len(faces), 2) # Euler: closed
        a, b, c = np.moveaxis(vertices[faces], 1, 0)
        self.assertGreater(np.einsum("ij,ij->i", np.cross(b - a, c - a), a).min(), 0) # faces look outwards
        scene = forceshade.Scene({"surface": {"kind": "mesh"}}, {"force.stiffness": "2 N/mm"}, mesh=(vertices, faces))
        force = scene.forces([0, 0, 0.0175])
        self.assertGreater(force[2], 0)
        half = forceshade.Scene({"surface": {"kind": "mesh"}}, mesh=(vertices, faces)).forces([0, 0, 0.0175])
        np.testing.assert_array_equal(force, 2 * half)

    def test_renderers_are_scored_against_the_oracle(self):
        class Spring(forceshade.Renderer): # of the plane alone, a tenth too stiff from its second stroke on
            strokes = 0

            def reset(self):
                self.strokes += 1

            def update(self, probe):
                return [0, 0, max(-probe[2], 0) * (1000 if self.strokes < 2 else 1100)]

        scene = forceshade.Scene({"surface": {"kind": "bump", "facets": 2}}, {"run.precision": "f64"})
        press = np.stack([np.full(400, 0.1), np.zeros(400), 1e-3 * np.cos(np.linspace(0, 2 * np.pi, 400))], -1)
        strokes = [press, press + [0.01, 0, 0]]
        scores = forceshade.score(scene, strokes, {"spring": Spring(),
                                                   "own": [scene.forces(stroke) for stroke in strokes]})
        self.assertEqual(list(scores), ["oracle", "spring", "own"])
        for name in ("oracle", "own"):
            np.testing.assert_array_equal(scores[name]["error_rms_N"], 0)
        np.testing.assert_allclose(scores["spring"]["error_percent"], [0, 10], atol=1e-9)
        self.assertTrue((scores["spring"]["update_us"] > 0).all())
        np.testing.assert_array_equal(scores["spring"]["pop_throughs"], 0)
        for wrong, words in (([], "at least one"), ([np.zeros((3, 2))], "stroke 0.*\\(n, 3\\)"),
                             ([1000 * press], "stroke 0: positions reach 100 m.*metres")):
            with self.assertRaisesRegex(forceshade.SceneError, words):
                forceshade.score(scene, wrong, {})
        with self.assertRaisesRegex(forceshade.SceneError, "forces of stroke 0: 3, its positions are 400"):
            forceshade.score(scene, [press], {"short": [np.zeros((3, 3))]})

    def test_vertices_given_twice_are_one_and_what_is_wrong_is_said(self):
        vertices, faces = forceshade.sphere(0.02, 2)
        scene = {"surface": {"kind": "mesh"}, "force": {"shading": "mean_value"}, "run": {"precision": "f64"}}
        points = np.random.default_rng(1).normal(0, 0.01, (500, 3))
        joined = forceshade.Scene(scene, mesh=(vertices, faces)).forces(points)
        apart = forceshade.Scene(scene, mesh=(vertices[faces].reshape(-1, 3),
                                              np.arange(3 * len(faces)).reshape(-1, 3))).forces(points)
        np.testing.assert_array_equal(joined, apart)
        with self.assertWarnsRegex(forceshade.SceneWarning, "^mesh: 180 edges between facets of opposite orientation|"
                                                            "^mesh: .*faces inward"):
            inward = forceshade.Scene(scene, mesh=(vertices, faces[:, ::-1]))
        self.assertEqual(np.abs(inward.forces(points)).max(), 0)
        turned = forceshade.Scene(scene, {"surface.orient": "outward"}, mesh=(vertices, faces[:, ::-1])).forces(points)
        np.testing.assert_allclose(turned, joined, atol=1e-9)
        for wrong, words in (([[0, 1, 1000]], "facet 0 has the vertex 1000"), ([[0, 1, -1]], "vertex -1"),
                             ([[0, 1, 1.5]], "list of vertex numbers"), ([], "no facets")):
            with self.assertRaisesRegex(forceshade.SceneError, words):
                forceshade.Scene(scene, mesh=(vertices, wrong))

    def test_forces_do_not_depend_on_how_vertices_are_given(self):
        """Of spot, and of the OBJ files that FORCESHADE_MESHES names, with colons between them."""
        random = np.random.default_rng(5)
        for file in [SPOT["surface"]["file"], *filter(None, os.environ.get("FORCESHADE_MESHES", "").split(":"))]:
            with open(file, encoding="utf-8") as lines:
                words = [line.split() for line in lines]
            vertices = np.array([line[1:4] for line in words if line[:1] == ["v"]], float)
            faces = [[int(corner.split("/")[0]) - 1 for corner in line[1:]] for line in words if line[:1] == ["f"]]
            low, high = vertices.min(axis=0), vertices.max(axis=0)
            points = random.uniform(low, high, (1000, 3))
            corners = [corner for face in faces for corner in face]
            ends = np.cumsum([len(face) for face in faces])
            apart = vertices[corners], [list(range(end - len(face), end)) for face, end in zip(faces, ends)]
            right = [vertices[face, 0].mean() > (low[0] + high[0]) / 2 for face in faces]
            seam = (np.vstack([vertices, vertices]),
                    [[corner + len(vertices) * beyond for corner in face] for face, beyond in zip(faces, right)])
            order, places = random.permutation(len(faces)), random.permutation(len(vertices))
            numbers = np.argsort(places)
            shuffled = vertices[places], [numbers[faces[face]] for face in order]
            off = np.nextafter(apart[0], apart[0] + random.choice([-1, 0, 1], apart[0].shape)), apart[1]
            for normals in ("plain", "angle"):
                def forces(mesh, **keys):
                    with warnings.catch_warnings():
                        warnings.simplefilter("ignore") # of what the meshes are like
                        return forceshade.Scene({"surface": {"kind": "mesh", "normals": normals, **keys},
                                                 "force": {"shading": "mean_value"}, "run": {"precision": "f64"}},
                                                mesh=mesh).forces(points)
                whole = forces((vertices, faces))
                largest = np.abs(whole).max()
                self.assertGreater(np.count_nonzero(whole.any(axis=1)), 100)
                np.testing.assert_array_equal(forces(apart), whole)
                np.testing.assert_array_equal(forces(seam), whole)
                np.testing.assert_allclose(forces(shuffled), whole, rtol=0, atol=1e-12 * largest)
                welded = forces(off, weld=f"{1e-9 * (high - low).max()} m")
                np.testing.assert_allclose(welded, whole, rtol=0, atol=1e-12 * largest)

    def test_normals_of_the_file_turn_the_force(self):
        vertices, faces = forceshade.sphere(0.02, 2)
        lines = [f"v {x} {y} {z}" for x, y, z in vertices] + ["vn 0 1 3"]
        lines += ["f " + " ".join(f"{corner + 1}//1" for corner in face) for face in faces]
        with open(self.path("sphere.obj"), "w", encoding="ascii") as file:
            file.write("\n".join(lines) + "\n")
        surface = {"kind": "mesh", "file": self.path("sphere.obj"), "normals": "file"}
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            scene = forceshade.Scene({"surface": surface, "force": {"shading": "mean_value"}})
        self.assertIn("behind their facet", str(caught[0].message)) # on the lower half
        contact = scene.contact([0.001, 0.002, 0.017])
        np.testing.assert_allclose(forceshade.angle(contact.force, [0, 1, 3]), 0, atol=1e-4)
        np.testing.assert_allclose(np.linalg.norm(contact.force), np.linalg.norm(contact.unshaded), rtol=1e-6)

    def test_paths_follow_a_sphere_on_both_engines(self):
        mesh = forceshade.sphere(0.02, 4)
        touched = []
        for follow in ("plane", "surface"):
            scene = forceshade.Scene({"surface": {"kind": "mesh"}, "paths": {"follow": follow, "count": 3, "steps": 300,
                                                                             "depth": "1 mm"}}, mesh=mesh)
            explored, device = scene.explore(), scene.explore(engine="gpu")
            np.testing.assert_array_equal(explored.force, device.force)
            touched.append((explored.facet >= 0).mean())
        self.assertLess(touched[0], 0.5)
        self.assertEqual(touched[1], 1)

    def test_warnings_are_python_warnings(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            vertices, faces = forceshade.sphere(0.02, 1)
            forceshade.Scene({"surface": {"kind": "mesh"}}, mesh=(vertices, faces[1:])) # open
        self.assertTrue(any(issubclass(one.category, forceshade.SceneWarning) for one in caught))

    def test_thin_meshes_are_in_double_unless_a_precision_is_named(self):
        corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1e-3], [1, 0, 1e-3], [0, 1, 1e-3]])
        faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]
        for named, dtype in ((None, np.float64), ("auto", np.float64), ("f32", np.float32)):
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                scene = forceshade.Scene({"surface": {"kind": "mesh"}}, {"run.precision": named} if named else {},
                                         mesh=(corners, faces))
            self.assertEqual(scene.contact([0.2, 0.2, 0.9e-3]).force.dtype, dtype)
            self.assertEqual(any("too thin for f32" in str(one.message) for one in caught), dtype == np.float64)

    def test_arrays_outlive_their_scene(self):
        field = forceshade.Scene(BUMP).field()
        expected = field.force.copy()
        gc.collect()
        np.testing.assert_array_equal(field.force, expected)

    def test_xarray(self):
        try:
            import xarray # noqa: F401
        except ModuleNotFoundError:
            self.skipTest("python3-xarray is not installed")
        data = forceshade.Scene(BUMP).field(["depth"]).xarray()
        self.assertEqual(data["force"].dims, ("z", "y", "x", "component"))
        self.assertEqual(float(data["depth"].max()), float(data["depth"].sel(z=data.z[0]).max()))


class Threads(unittest.TestCase):
    POINTS = np.random.default_rng(1).normal(0, 0.01, (1 << 20, 3))

    def test_other_threads_go_on(self):
        scene, ticks, done = forceshade.Scene(SPOT), 0, threading.Event()

        def evaluate():
            scene.forces(self.POINTS, threads=1)
            done.set()

        thread = threading.Thread(target=evaluate)
        thread.start()
        while not done.wait(0.005):
            ticks += 1
        thread.join()
        self.assertGreater(ticks, 3) # with the lock held there would be none

    def test_ctrl_c_ends_long_work(self):
        scene = forceshade.Scene(SPOT)
        for work in (lambda: scene.forces(np.tile(self.POINTS, (8, 1))),
                     lambda: scene.explore([self.POINTS])):
            signal.setitimer(signal.ITIMER_REAL, 0.3)
            signal.signal(signal.SIGALRM, lambda *_: os.kill(os.getpid(), signal.SIGINT))
            begin = time.process_time()  # whatever else the machine does
            with self.assertRaises(KeyboardInterrupt):
                work()
            self.assertLess(time.process_time() - begin, 3)


if __name__ == "__main__":
    unittest.main()
