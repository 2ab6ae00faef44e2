#!/usr/bin/env python3
"""How time and memory grow with voxels, triangles, paths, cases and threads: whole commands, and the exponent p of
processor seconds ~ size^p between each size and the one before.

    tests/bench/growth.py [--program build/tests/forceshade] [--limit 120] [--only voxels,triangles,...] [--engine cpu]

Memory is the largest resident one; less than this script's own, some 40 MiB, is not seen.
A size is left out where the one before says that it would take longer than --limit seconds."""
import argparse
import array
import math
import os
import resource
import subprocess
import sys
import tempfile
import time

TRIANGLES = (5_000, 20_000, 100_000, 400_000, 1_000_000, 4_000_000)


def sphere(path, triangles):
    """A sphere of 20 mm of about so many triangles, as a binary PLY in mm."""
    rows = max(3, round(math.sqrt(triangles / 4)))
    columns = 2 * rows
    places = array.array("f", (0, 0, 20))
    for row in range(1, rows):
        polar = math.pi * row / rows
        for column in range(columns):
            turn = 2 * math.pi * column / columns
            places.extend((20 * math.sin(polar) * math.cos(turn), 20 * math.sin(polar) * math.sin(turn),
                           20 * math.cos(polar)))
    places.extend((0, 0, -20))
    last = (rows - 1) * columns + 1
    at = lambda row, column: 1 + (row - 1) * columns + column % columns
    faces = bytearray()
    count = 0
    for row in range(rows):
        for column in range(columns):
            a, b = (0, 0) if row == 0 else (at(row, column), at(row, column + 1))
            c, d = (last, last) if row == rows - 1 else (at(row + 1, column), at(row + 1, column + 1))
            for corners in ((a, c, d), (a, d, b)):
                if len(set(corners)) == 3:
                    faces += b"\x03" + array.array("i", corners).tobytes()
                    count += 1
    with open(path, "wb") as file:
        file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(places) // 3}\nproperty float x\n"
                    f"property float y\nproperty float z\nelement face {count}\n"
                    f"property list uchar int vertex_indices\nend_header\n").encode())
        file.write(places.tobytes())
        file.write(faces)
    return count


class Bench:
    def __init__(self, arguments, folder):
        self.program = os.path.abspath(arguments.program)
        self.engine = arguments.engine
        self.limit = arguments.limit
        self.folder = folder

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w") as file:
            file.write(text)
        return path

    def out(self, name):
        return os.path.join(self.folder, name)

    def measured(self, arguments):
        """Wall seconds, processor seconds, largest resident bytes, and bytes written, of one command."""
        for name in os.listdir(self.folder):
            if name.startswith("out"):
                subprocess.run(["rm", "-rf", self.out(name)], check=True)
        begin = time.monotonic()
        process = subprocess.Popen([self.program, *arguments, "--engine", self.engine, "-q"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        error = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.monotonic() - begin
        if status != 0:
            sys.exit(f"{' '.join(arguments)} failed: {error.decode(errors='replace')}")
        written = int(subprocess.run(["du", "-sbc"] + [self.out(name) for name in os.listdir(self.folder)
                                                       if name.startswith("out")],
                                     capture_output=True, text=True, check=True).stdout.split("\n")[-2].split()[0])
        return wall, usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss, written

    def series(self, title, sizes, command):
        """`command(size)` returns the true size and the arguments."""
        print(f"\n{title}")
        print(f"{'size':>12} {'wall s':>9} {'CPU s':>9} {'p':>6} {'memory':>10} {'written':>10}")
        before = None
        for size in sizes:
            if before:
                slope = max(1, before[2])
                expected = before[1] * (size / before[0]) ** slope
                if expected > self.limit:
                    print(f"{size:>12} not run: some {expected:.0f} s expected, --limit {self.limit:g}")
                    break
            true_size, arguments = command(size)
            wall, busy, memory, written = self.measured(arguments)
            slope = math.log(busy / before[3]) / math.log(true_size / before[0]) if before else 0
            print(f"{true_size:>12} {wall:>9.2f} {busy:>9.2f} {f'{slope:.2f}' if before else '':>6} "
                  f"{memory / 2**20:>6.0f} MiB {written / 2**20:>6.0f} MiB", flush=True)
            before = (true_size, wall, slope, busy)

    def voxels(self):
        def command(side):
            scene = self.write("voxels.toml",
                               f'[surface]\nradius = "600 mil"\nfacets = 8\n[force]\nshading = "reference"\n'
                               f'[grid]\nsize = [{side}, {side}, {side}]\norigin = ["-16 mm", "-16 mm", "-8 mm"]\n'
                               f'spacing = "{32 / side:.6f} mm"\n')
            return side**3, ["field", scene, "--out", self.out("out.exr")]

        self.series_of_sides("voxels of a bump, written as EXR", (64, 128, 256, 512), command)

        def of_mesh(side):
            sphere(self.out("sphere.ply"), 20_000)
            scene = self.write("mesh.toml", f'[surface]\nkind = "mesh"\nfile = "sphere.ply"\nunit = "mm"\n'
                                            f'[grid]\nsamples = {side}\n')
            return side**3, ["field", scene, "--out", self.out("out.exr")]

        self.series_of_sides("voxels of a mesh of 20 000 triangles, written as EXR", (64, 128, 256, 512), of_mesh)

    def series_of_sides(self, title, sides, command):
        self.series(title, [side**3 for side in sides], lambda voxels: command(round(voxels ** (1 / 3))))

    def triangles(self):
        def scene_of(count, more):
            true = sphere(self.out("sphere.ply"), count)
            return true, self.write("mesh.toml",
                                    '[surface]\nkind = "mesh"\nfile = "sphere.ply"\nunit = "mm"\n' + more)

        def field(count):
            true, scene = scene_of(count, "[grid]\nsamples = 64\n")
            return true, ["field", scene, "--out", self.out("out.exr")]

        def paths(count):
            true, scene = scene_of(count, "[paths]\ncount = 100\nsteps = 1000\n")
            return true, ["explore", scene, "--metrics-only", "--out", self.out("out.csv")]

        self.series("triangles, a field of 64 samples along the longest side", TRIANGLES, field)
        self.series("triangles, 100 strokes of 1000 steps of the god-object", TRIANGLES, paths)

    def paths(self):
        def command(form, more):
            def of(count):
                scene = self.write("paths.toml", f'[surface]\nradius = "600 mil"\nfacets = 8\n'
                                                 f'[paths]\ncount = {count}\nsteps = 100\n'
                                                 f'depth = {{ min = "1 mm", max = "2 mm" }}\n')
                return count, ["explore", scene, *more, "--out", self.out("out." + form)]
            return of

        sizes = (1_000, 10_000, 100_000, 1_000_000)
        self.series("paths of 100 steps, their lines alone", sizes, command("csv", ["--metrics-only"]))
        self.series("paths of 100 steps, samples as CSV", sizes, command("csv", []))
        self.series("paths of 100 steps, samples as EXR", sizes, command("exr", []))
        self.series("paths of 100 steps, samples as NPY", sizes, command("npy", []))

    def cases(self):
        def command(count):
            radii = ", ".join(f'"{20 + 0.001 * i:.3f} mm"' for i in range(count))
            study = self.write("cases.toml", f'[surface]\nradius = [{radii}]\nfacets = 4\n'
                                             f'[grid]\nsize = [16, 1, 16]\n')
            return count, ["sweep", study, "--out", self.out("out")]

        self.series("cases of 16 x 16 voxels, with records and report", (10, 100, 1_000, 10_000, 100_000), command)

    def threads(self):
        scene = self.write("threads.toml", '[surface]\nradius = "600 mil"\nfacets = 8\n[grid]\nsize = [256, 256, 256]\n'
                                           'origin = ["-16 mm", "-16 mm", "-8 mm"]\nspacing = "0.125 mm"\n')
        self.series("threads, a field of 256 voxels along each side", range(1, len(os.sched_getaffinity(0)) + 1),
                    lambda count: (count, ["field", scene, "--jobs", str(count), "--out", self.out("out.exr")]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = ("voxels", "triangles", "paths", "cases", "threads")
    parser.add_argument("--program", default="build/tests/forceshade")
    parser.add_argument("--limit", type=float, default=120, help="s: of a command that is still tried")
    parser.add_argument("--only", default=",".join(names), help="of " + ", ".join(names))
    parser.add_argument("--engine", default="cpu", choices=("cpu", "gpu", "auto"))
    arguments = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with tempfile.TemporaryDirectory(prefix="forceshade-growth-") as folder:
        bench = Bench(arguments, folder)
        for name in arguments.only.split(","):
            if name not in names:
                parser.error(f"--only {name}: of {', '.join(names)}")
            getattr(bench, name)()


if __name__ == "__main__":
    main()
