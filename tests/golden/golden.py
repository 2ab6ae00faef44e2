#!/usr/bin/python3
"""Golden numbers: SHA-256 of pixels, arrays, tables and logs of a broad set of runs, held against golden.sha256.

    golden.py PROGRAM            compares, exit 1 where a number moved
    golden.py PROGRAM --update   writes golden.sha256 anew: only where numbers are meant to change, and the commit says why

Hashed are numbers alone: pixels with their channel names (not headers, which name the version), CSV and NPY bytes, the columns of a
live log that depend on no clock, and the tables of `validate`.
"""
import csv, hashlib, itertools, os, shutil, subprocess, sys, tempfile, threading
from concurrent.futures import ThreadPoolExecutor
import OpenImageIO as oiio

here = os.path.dirname(os.path.abspath(__file__))
spot = os.path.join(os.path.dirname(here), "data", "spot.obj")
bump_mesh = os.path.join(os.path.dirname(here), "data", "bump.obj")

bump = 'kind = "bump"\nradius = "600 mil"\nfacets = %d'
cylinder = 'kind = "cylinder_bump"\nradius = "600 mil"'
height_map = 'kind = "height_map"\nfunction = "%s"\n%s'
mesh = 'kind = "mesh"\nfile = "%s"\ntransform = { scale = 0.05, rotate = ["90 deg", "0 deg", "0 deg"] }'
patch = 'kind = "mesh"\nfile = "%s"\ninside = "winding"'
grid = 'size = [64, 8, 40]\norigin = ["-20 mm", "-4 mm", "-8 mm"]\nspacing = "0.61 mm"'
box = 'size = [40, 24, 24]\norigin = ["-13 mm", "-13 mm", "-3 mm"]\nspacing = "0.57 mm"'
sine = '[texture]\nstiffness = "0.2 N/mm"\nfunction = "sine"\nwidth = "2 mm"\nheight = "0.1 mm"\n'
dimple = '[texture]\nstiffness = "0.2 N/mm"\nfunction = "gaussian"\nradius = "5 mm"\nheight = "0.1 mm"\n'
bumpy = sine.replace('stiffness = "0.2 N/mm"', 'effect = "normal"')
analytic = {"cylinder": 'radius = "600 mil"\nwidth = "1000 mil"', "dip": 'radius = "600 mil"\nwidth = "1000 mil"',
            "sine": 'width = "9 mm"\nheight = "1 mm"', "gaussian": 'radius = "5 mm"\nheight = "1 mm"'}


def scene(surface, force="", extra="", space=grid, channels='["force", "depth", "facet", "proxy", "unshaded"]'):
    grids = f"[grid]\n{space}\n" if space else ""
    return f"[surface]\n{surface}\n[force]\n{force}\n{grids}[output]\nchannels = {channels}\n{extra}"


def fields():
    for facets, shading, depth in itertools.product((1, 3, 64), ("none", "reference"), ("vertical", "normal")):
        yield f"bump-{facets}-{shading}-{depth}", scene(bump % facets, f'shading = "{shading}"\ndepth = "{depth}"')
    yield "bump-radial", scene(bump % 2, 'shading = "reference"\nreference = "radial"')
    yield "bump-equal-x", scene(bump % 5 + '\nfacet_spacing = "equal_x"', 'shading = "reference"')
    yield "bump-textured", scene(bump % 2, 'shading = "reference"', sine, box)
    yield "bump-dimpled", scene(bump % 2, 'shading = "reference"', dimple, box)
    yield "cylinder", scene(cylinder)
    for function, size in analytic.items():
        yield f"map-{function}", scene(height_map % (function, size), 'shading = "height_map"', "", box)
    yield "map-textured", scene(height_map % ("gaussian", analytic["gaussian"]), 'shading = "height_map"', sine, box)
    yield "map-image", scene('kind = "height_map"\nfile = "height.png"\nsize = ["25.4 mm", "20 mm"]\nheight = "1 mm"',
                             'shading = "height_map"', "", box)
    for shading in ("none", "morgenbesser", "mean_value", "two_pass"):
        yield f"spot-{shading}", scene(mesh % spot, f'shading = "{shading}"', "", "samples = 32")
    yield "spot-angle", scene(mesh % spot + '\nnormals = "angle"', 'shading = "mean_value"', "", "samples = 24")
    yield "spot-winding", scene(mesh % spot + '\ninside = "winding"', 'shading = "mean_value"', "", "samples = 24")
    yield "spot-textured", scene(mesh % spot, 'shading = "mean_value"', sine, "samples = 24")
    yield "spot-bumpy", scene(mesh % spot, 'shading = "mean_value"', bumpy, "samples = 24")
    yield "solid-barycentric", scene(mesh % "solid.obj", 'shading = "barycentric"', "", "samples = 32")
    yield "patch", scene(patch % bump_mesh, 'shading = "morgenbesser"', "", "samples = 32")


def paths():
    kinds = ("strokes", "raster", "circle", "spiral", "taps", "random_walk", "minimum_jerk")
    surfaces = {"bump": (bump % 3, "reference"), "flat": (bump % 2, "none"),
                "map": (height_map % ("gaussian", analytic["gaussian"]), "height_map"), "spot": (mesh % spot, "mean_value"),
                "patch": (patch % bump_mesh, "morgenbesser")}
    for (name, (surface, shading)), kind in itertools.product(surfaces.items(), kinds):
        if name in ("spot", "patch", "flat") and kind in ("raster", "spiral"):
            continue
        for hand in ("depth", "press"):
            pressing = 'press = "1 N"' if hand == "press" else 'depth = "1 mm"'
            if kind == "taps" and hand == "press":
                pressing = 'depth = "1 mm"\nloop = "closed"'
            motion = f'[paths]\nkind = "{kind}"\ncount = 12\nsteps = 600\n{pressing}\n'
            if kind == "strokes":
                motion += 'speed = { mean = "40 mm/s", sd = "5 mm/s" }\n'
            yield f"{name}-{kind}-{hand}", scene(surface, f'shading = "{shading}"', motion, None)
    hand = '[hand]\ndelay_samples = 1\nquantisation = "0.02 mm"\ncoulomb = "0.05 N"\n'
    strokes = '[paths]\nkind = "strokes"\ncount = 12\nsteps = 600\npress = "1 N"\n'
    for name in ("bump", "map", "spot"):
        surface, shading = surfaces[name]
        yield f"{name}-late-hand", scene(surface, f'shading = "{shading}"', strokes + hand, None)


def lives():
    strokes = '[paths]\nkind = "strokes"\ncount = 1\nspeed = "60 mm/s"\npress = "1 N"\n'
    yield "bump", scene(bump % 3, 'shading = "reference"', strokes, None)
    yield "map", scene(height_map % ("gaussian", analytic["gaussian"]), 'shading = "height_map"', strokes, None)
    yield "spot", scene(mesh % spot, 'shading = "mean_value"', strokes, None)


def run(*words, code=0):
    made = subprocess.run([program, "--quiet", *words], stdin=subprocess.DEVNULL, capture_output=True, cwd=folder)
    if made.returncode != code:
        sys.exit(f"{' '.join(words)}: exit {made.returncode}\n{made.stderr.decode()}")
    return made.stdout


one_reader = threading.Lock()  # OpenImageIO's bindings have been seen to wait for each other forever


def pixels(path):
    with one_reader:
        return hashed_pixels(path)


def hashed_pixels(path):
    digest = hashlib.sha256()
    image = oiio.ImageInput.open(path)
    part = 0
    while image.seek_subimage(part, 0):
        spec = image.spec()
        digest.update(repr((spec.get_string_attribute("name"), spec.channelnames, spec.width, spec.height)).encode())
        digest.update(image.read_image(part, 0, 0, spec.nchannels, oiio.TypeUnknown).tobytes())
        part += 1
    image.close()
    return digest.hexdigest()


def content(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def without_clock(path):
    """A live log's rows without the columns that tell when the machine came to them."""
    with open(path, encoding="ascii") as file:
        rows = [line.rstrip("\n").split(",") for line in file]
    kept = [rows[0].index(name) for name in "path t x y z gx gy gz fx fy fz depth facet cx cy cz energy".split()]
    return hashlib.sha256("\n".join(",".join(row[i] for i in kept) for row in rows).encode()).hexdigest()


def write(name, text):
    with open(os.path.join(folder, name), "w", encoding="ascii") as file:
        file.write(text)
    return name


def field(name, text, precision, engine):
    stem = f"field-{name}-{precision}-{engine}"
    run("field", write(stem + ".toml", text), "--out", stem + ".exr", "--also", "npy", "--engine", engine, "--precision", precision)
    out = {stem + " pixels": pixels(os.path.join(folder, stem + ".exr"))}
    out[stem + " npy"] = content(os.path.join(folder, stem + ".force.npy"))
    return out


def explored(name, text, precision, engine):
    stem = f"paths-{name}-{precision}-{engine}"
    source = write(stem + ".toml", text)
    run("explore", source, "--out", stem + ".exr", "--also", "npy", "--engine", engine, "--precision", precision)
    out = {stem + " pixels": pixels(os.path.join(folder, stem + ".exr"))}
    for end in ("force.npy", "position.npy", "paths.csv"):
        out[f"{stem} {end}"] = content(os.path.join(folder, f"{stem}.{end}"))
    if engine == "cpu" or name.endswith("late-hand"):  # rows are written alike
        run("explore", source, "--out", stem + "-rows.csv", "--engine", engine, "--precision", precision)
        out[stem + " csv"] = content(os.path.join(folder, stem + "-rows.csv"))
    return out


def felt(name, text, precision):
    stem = f"live-{name}-{precision}"
    source = write(stem + ".toml", text)
    common = ("--fast", "--precision", precision, "--log")
    run("live", source, "--device", "sim", "--duration", "2 s", *common, stem + ".csv")
    run("live", source, "--device", f"replay:{stem}.csv", *common, stem + "-again.csv")
    run("explore", source, "--paths", stem + ".csv", "--open-loop", "--out", stem + "-rows.csv", "--engine", "cpu", "--precision", precision)
    return {stem + " log": without_clock(os.path.join(folder, stem + ".csv")),
            stem + " replay": without_clock(os.path.join(folder, stem + "-again.csv")),
            stem + " csv": content(os.path.join(folder, stem + "-rows.csv"))}


def validated(name, text):
    stem = f"validate-{name}"
    said = run("validate", write(stem + ".toml", text))
    searched = (b"f32 against f64", b"where two facets")  # a search, which the machine's cosine steers
    kept = b"".join(line for line in said.splitlines(True) if not line.startswith(searched))
    return {stem: hashlib.sha256(kept).hexdigest()}


def swept():
    run("sweep", "--out", "sweep", "--only", "bump_radius-600mil_*", "--engine", "gpu")
    made = sorted(os.listdir(os.path.join(folder, "sweep")))
    out = {f"sweep {name}": pixels(os.path.join(folder, "sweep", name)) for name in made if name.endswith(".exr")}
    # without what was left out, in words, the errors where a hand touches, at places by the machine's pow, and the volumes'
    # sizes and hashes, in which the version counts
    with open(os.path.join(folder, "sweep", "summary.csv"), encoding="ascii") as file:
        table = list(csv.reader(file))
    words = table[0].index("left_out")
    rows = "".join(",".join(row[:words] + row[words + 1:-4]) + "\n" for row in table)
    out["sweep summary.csv"] = hashlib.sha256(rows.encode()).hexdigest()
    return out


def make_inputs():
    image = oiio.ImageBuf(oiio.ImageSpec(33, 21, 1, "uint16"))
    for y, x in itertools.product(range(21), range(33)):
        image.setpixel(x, y, ((x * x * 7 + y * 131 + x * y * 3) % 1021 / 1021.0,))
    image.write(os.path.join(folder, "height.png"))
    corners = [(0, 0, 1), (0, 0, -1)] + [(c, s, 0) for c, s in ((1, 0), (.5, .875), (-.5, .875), (-1, 0), (-.5, -.875), (.5, -.875))]
    facets = [(1, 3 + i, 3 + (i + 1) % 6) for i in range(6)] + [(2, 3 + (i + 1) % 6, 3 + i) for i in range(6)]
    write("solid.obj", "".join("v %g %g %g\n" % tuple(0.01 * a for a in c) for c in corners)
          + "".join("f %d %d %d\n" % f for f in facets))


def jobs():
    for (name, text), precision, engine in itertools.product(fields(), ("f32", "f64"), ("gpu", "cpu")):
        yield field, name, text, precision, engine
    for (name, text), precision, engine in itertools.product(paths(), ("f32", "f64"), ("gpu", "cpu")):
        if engine == "gpu" and name.startswith(("spot", "patch")) and "strokes" not in name:
            continue  # the software device takes long over these; its bits are gpu_mesh_paths'
        yield explored, name, text, precision, engine
    for (name, text), precision in itertools.product(lives(), ("f32", "f64")):
        yield felt, name, text, precision
    for name, text in fields():
        if name in ("bump-3-reference-vertical", "map-gaussian", "map-textured", "cylinder", "spot-mean_value", "patch"):
            yield validated, name, text
    for name, text in paths():
        if name in ("bump-strokes-press", "map-circle-depth", "spot-strokes-press"):
            yield validated, name, text
    yield (swept,)


program = os.path.abspath(sys.argv[1])
os.environ["VK_LOADER_DRIVERS_SELECT"] = "*lvp*"  # the software device, whatever the machine has
folder = tempfile.mkdtemp(prefix="forceshade-golden-")
try:
    make_inputs()
    found = {}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for made in pool.map(lambda job: job[0](*job[1:]), list(jobs())):
            found.update(made)
finally:
    shutil.rmtree(folder, ignore_errors=True)

table = os.path.join(here, "golden.sha256")
if "--update" in sys.argv:
    with open(table, "w", encoding="ascii") as file:
        file.writelines(f"{digest}  {name}\n" for name, digest in found.items())
with open(table, encoding="ascii") as file:
    golden = dict(reversed(line.rstrip("\n").split("  ", 1)) for line in file)
moved = [name for name in golden.keys() | found.keys() if golden.get(name) != found.get(name)]
print(f"{len(golden)} golden numbers, {len(moved)} moved")
for name in sorted(moved):
    print(" ", name, "is new" if name not in golden else "was not made" if name not in found else "differs")
sys.exit(1 if moved else 0)
