#!/usr/bin/python3
"""Recomputes numbers of results/reference by formulas of its own, which share no code with the studies.

    recomputed.py [--tables FOLDER]   prints a line for each number; exit 1 where one is off

Lengths are in m; forces are over K, in m, unless their unit is said. Random numbers have fixed seeds.
"""
import argparse
import csv
import math
import pathlib
import sys
import numpy as np
from recomputed_checks import check, near, number, outcomes, place_of
from recomputed_models import HALF, TIGHT, Block, Patch, angles, axis_steps, bump_force, circle_height, \
    facets_at, least_growing, loop_growth, nearest_on, own_surfaces, rms, round_normals, size, slope_of, splitmix, \
    turned, unit
from recomputed_loops import check_atlas, check_basins, check_couplings, check_edges, check_rounded
from recomputed_perception import check_perception

DEEPEST = 2e-3  # m: of a hand


# Jumps of a static field where two facets are equally near.

def check_jumps(rows):
    """worst_rounding.csv: the foot of the bump in closed form; of meshes each row at its place, and a search."""
    kept = {row["law"]: row for row in rows if row["facet"] == "another facet"}
    for law in ("bump of 8 facets", "shaded bump of 8 facets"):
        normal = unit(bump_force(np.array([HALF - 1e-9, 0, -1]), 8, TIGHT, "shaded" in law))
        near(f"{law}: jump at the foot", float(kept[law]["error_1"]), size(normal - [0, 0, 1]), 1e-4)
    for what, count in (("mesh", 8), ("thin mesh", 256)):
        block, most = Block(TIGHT, 8, count), dict.fromkeys(("none", "morgenbesser", "barycentric", "two_pass"), 0)
        for i, j, at in block.under_ridges(DEEPEST, 101):
            sides = [(face, at + DEEPEST * block.normals[face]) for face in (i, j)]
            corners = [block.located(*side) for side in sides]
            for shading in most:
                one, other = (block.force(shading, c, foot, block.normals[face], 1)
                              for (face, foot), c in zip(sides, corners))
                most[shading] = max(most[shading], size(one - other).max())
        for shading in (*most, "mean_value"):
            name = {"none": "", "mean_value": "shaded "}.get(shading, shading + " ") + what
            row = kept[name]
            table, own = float(row["error_1"]), "barycentric" if shading == "mean_value" else shading
            near(f"{name}: jump there", table, block.jump_at(own, place_of(row)) / DEEPEST, 1e-3)
            found = max(most[own], block.jumps_within(own, DEEPEST) / DEEPEST)
            low, high = (0.9, 1.1) if own == "two_pass" else (0.98, 1.02)  # two_pass grows steeply towards its worst
            check(f"{name}: largest jump", table, found, low * table, high * table)


# Errors of volumes with samples 0.1 mm apart of the shaded bump of 64 facets, and of meshes of 16 x 16 cells.

LOW, HIGH = np.array([-0.0147, -0.002, -0.0025]), np.array([0.0147015, 0.0019998, 0.00695])  # m: the bump's box


def true_force(at):
    """m: of the smooth bump."""
    return np.maximum(circle_height(at[:, 0], TIGHT) - at[:, 2], 0)[:, None] * round_normals(at[:, 0], TIGHT)


def trilinear(place, cell, value_at):
    """Between the values at the corners of cells with this edge, m, whose corners are multiples of it."""
    share, first = np.modf(place / cell)
    return sum(np.where(corner, share, 1 - share).prod(1)[:, None] * value_at((first + corner) * cell)
               for corner in np.ndindex(2, 2, 2))


def forces_read(at, axes, begin, of_depth, spacing):
    """m: read by trilinear interpolation between forces, or between signed depths and directions, at samples along
    `axes` (columns), the first at `begin`."""
    def sampled(place):
        sample = (place + begin) @ axes.T
        depth = facets_at(sample[:, 0], 64, TIGHT)[0] - sample[:, 2]
        normals = round_normals(sample[:, 0], TIGHT)
        return np.column_stack([depth, normals]) if of_depth else np.maximum(depth, 0)[:, None] * normals
    read = trilinear(at @ axes - begin, spacing, sampled)
    return np.maximum(read[:, :1], 0) * unit(read[:, 1:]) if of_depth else read


def octree(axes, random):
    """A reader of bricks of 4 x 4 x 4 cells along `axes`, halved where they err most, in as many bytes as forces at
    samples 0.1 mm apart have."""
    reach = abs(axes).T @ (HIGH - LOW) / 2
    begin, cells = -reach - 1e-4 * (2 + random.random(3)), np.ceil(2e4 * reach).astype(int) + 5
    roots, edge = np.ceil(cells / 32).astype(int), 32e-4
    inside = lambda at: (at - (LOW + HIGH) / 2) @ axes - begin
    force_at = lambda place: bump_force((place + begin) @ axes.T + (LOW + HIGH) / 2, 64, TIGHT, True)

    def errors_of(low, edges):
        """m^3: the squares of relative errors in the middles of cells, over their volume."""
        nodes = np.array(list(np.ndindex(5, 5, 5)))
        samples = force_at(low[:, None] + nodes * edges[:, None, None] / 4).reshape(-1, 5, 5, 5, 3)
        middles = low[:, None] + (nodes[(nodes < 4).all(1)] + 0.5) * edges[:, None, None] / 4
        truth = force_at(middles)
        read = sum(samples[:, i:i + 4, j:j + 4, k:k + 4] for i, j, k in np.ndindex(2, 2, 2)).reshape(truth.shape) / 8
        counts = (size(truth) <= 2 * DEEPEST) & (middles <= cells * 1e-4).all(-1)
        return (counts * (size(read - truth) / (size(truth) + 0.04 * DEEPEST))**2).sum(1) * edges**3
    low = edge * np.array(list(np.ndindex(*roots)))
    edges, child = np.full(len(low), edge), np.full(len(low), -1)
    errors, brick = errors_of(low, edges), 12 * 5**3 + 4  # bytes
    while (left := int((12 * (cells + 1).prod() / brick - (child < 0).sum()) / 7)) > 0:
        worst = np.argsort(np.where(child < 0, errors, -1))[-max(1, left // 6):]
        child[worst] = len(low) + 8 * np.arange(len(worst))
        halves = np.repeat(edges[worst] / 2, 8)
        more = np.repeat(low[worst], 8, 0) + np.tile(list(np.ndindex(2, 2, 2)), (len(worst), 1)) * halves[:, None]
        errors = np.append(errors, errors_of(more, halves))
        low, edges, child = np.vstack([low, more]), np.append(edges, halves), np.append(child, [-1] * len(more))

    def read(at):
        place = inside(at)
        node = np.ravel_multi_index((place // edge).astype(int).T, roots)
        while (child[node] >= 0).any():
            half = (place >= low[node] + edges[node][:, None] / 2) @ [4, 2, 1]
            node = np.where(child[node] >= 0, child[node] + half, node)
        return trilinear(place - low[node], edges[node][:, None] / 4, lambda within: force_at(low[node] + within))
    return read


def volume(of_depth, spacing):
    """Of axes and random numbers the reader of such a volume."""
    def made(axes, random):
        begin = -0.05 - spacing * random.random(3)
        return lambda at: forces_read(at, axes, begin, of_depth, spacing)
    return made


def volume_errors(made, draws):
    """Of random places and volumes, moved, turned and tilted by up to 2 deg: the RMS error over the RMS force, the
    direction's RMS error at the rim, deg, the share of places just above the surface that have a force, and the largest
    of these over the RMS force."""
    rows = []
    for draw in range(draws):
        random = np.random.default_rng([2, draw])
        turn, aside, tilt = random.random(3) * [2 * math.pi, 2 * math.pi, math.radians(2)]
        read = made(turned(aside, 2) @ turned(tilt, 0) @ turned(turn - aside, 2), random)

        def touched(x, deep):
            """Places under or above points of the surface, along its normals."""
            flat = np.stack([x, random.uniform(LOW[1], HIGH[1], len(x)), circle_height(x, TIGHT)], 1)
            return flat - deep[:, None] * round_normals(x, TIGHT)
        deep = DEEPEST * 100 ** -random.random(4000)  # log-uniform
        at = touched(random.uniform(LOW[0], HIGH[0], 4000), deep)
        whole = rms(size(true_force(at)))
        error = rms(size(read(at) - true_force(at))) / whole
        x = (HALF + random.uniform(-4e-4, 2e-4, 4000)) * random.choice([-1, 1], 4000)
        rim = touched(x, deep)
        rim = rim[abs(abs(rim[:, 0]) - HALF) < 1e-4 * round_normals(x, TIGHT)[:, 2]]  # 0.1 mm along the surface
        found, truth = read(rim), true_force(rim)
        both = found.any(1) & truth.any(1)
        x = random.uniform(LOW[0], HIGH[0], 2000)
        above = touched(x, -5e-5 * (2.5 ** random.random(2000) - 1) / 1.5)[abs(abs(x) - HALF) > 2e-4]
        above = above[~true_force(above).any(1)]
        phantom = size(read(above))
        rows.append((error, rms(angles(found[both], truth[both])), (phantom > 0).mean(), phantom.max() / whole))
    return np.array(rows).T


def mesh_errors(draws):
    """Of random tessellations and places: the direction's RMS error unshaded and shaded, deg, and the median error of
    the force's size."""
    cell, count, rows = np.array([TIGHT * math.asin(HALF / TIGHT), HALF]) / 8, 12, []  # m: along the arc and across
    halves = lambda v: np.stack([np.stack([v[:-1, :-1], one, other], -2) for one, other in (
        (v[1:, :-1], v[1:, 1:]), (v[1:, 1:], v[:-1, 1:]))], 2)  # of each cell two triangles
    for draw in range(draws):
        random = np.random.default_rng([3, draw])
        spin, moved = turned(random.uniform(0, 2 * math.pi), 2)[:2, :2], random.random(2)
        grid = np.stack(np.meshgrid(*2 * [np.arange(-count, count + 1)], indexing="ij"), -1)
        flat = ((grid + moved) * cell) @ spin.T
        turn = flat[..., 0] / TIGHT
        triangles = halves(np.stack([TIGHT * np.sin(turn), flat[..., 1], TIGHT * np.cos(turn)], -1))
        a, b, c = (triangles[..., k, :] for k in range(3))
        normals, sums = unit(np.cross(b - a, c - a)), np.zeros((*grid.shape[:2], 3))
        for x, y, which in ((0, 0, [0, 1]), (1, 0, [0]), (1, 1, [0, 1]), (0, 1, [1])):  # of six at a vertex
            sums[x:x + 2 * count, y:y + 2 * count] += normals[:, :, which].sum(2)
        turn = random.uniform(-0.66, 0.66, 2500)
        far = TIGHT - DEEPEST * 100 ** -random.random(len(turn))
        at = np.stack([far * np.sin(turn), random.uniform(-6e-3, 6e-3, len(turn)), far * np.cos(turn)], 1)
        turn, far, at = (values[abs(at[:, 0]) < 9e-3] for values in (turn, far, at))
        middle = np.floor((np.stack([TIGHT * turn, at[:, 1]], 1) @ spin) / cell - moved).astype(int) + count - 1
        around = lambda v: np.concatenate([v[tuple((middle + step).T)] for step in np.ndindex(3, 3)], 1)
        points, facing = nearest_on(around(triangles), at)
        first = size(points - at[:, None]).argmin(1)
        mine = lambda values: values[np.arange(len(at)), first]
        force, normal, corners = mine(points) - at, mine(facing), mine(around(triangles)) - mine(points)[:, None]
        areas = [(np.cross(corners[:, k - 2], corners[:, k - 1]) * normal).sum(1) for k in range(3)]
        shaded = (np.stack(areas, 1)[..., None] * mine(around(halves(unit(sums))))).sum(1)
        truth, met = np.stack([np.sin(turn), 0 * turn, np.cos(turn)], 1), (force * normal).sum(1) > 0
        off = abs(size(force) / (TIGHT - far) - 1)[met]
        rows.append((*(rms(angles(one, truth)[met]) for one in (force, shaded)), np.median(off)))
    return np.array(rows).T


def check_errors(draws, ways):
    """draws.csv: the median of draws; and whether they may be of the same distribution (Kolmogorov & Smirnov: one pair
    in a hundred is further apart)."""
    def against(name, way, column, own, share):
        kept = np.array([float(row[column]) for row in draws if row["way"] == way])
        near(f"{name}, median", np.median(kept), np.median(own), share)
        apart = max(abs((kept <= x).mean() - (own <= x).mean()) for x in (*kept, *own))
        check(f"{name}, {kept.min():.3g} to {kept.max():.3g}, own {own.min():.3g} to {own.max():.3g}: apart",
              0, apart, 0, 1.63 * math.sqrt(1 / len(kept) + 1 / len(own)))
    for family, made, count in (
            ("trilinear 0.2 mm", volume(False, 2e-4), 40), ("trilinear 0.1 mm", volume(False, 1e-4), 40),
            ("depth and direction 0.1 mm", volume(True, 1e-4), 40), ("adaptive 0.1 mm", octree, 8)):
        way = f"bump, 64 facets, reference: look-up, {family}"
        error, rim, phantom, largest = volume_errors(made, count)
        against(f"{way}, RMS error", way, "typical_rms_1", error, 0.2)
        against(f"{way}, direction at the rim, deg", way, "rim_direction_rms_deg", rim, 0.1)
        kept, most = (np.median([float(row[column]) for row in draws if row["way"] == way])
                      for column in ("phantom_1", "phantom_max_1"))
        check(f"{way}, forces above the surface", kept, np.median(phantom), kept - 0.05, kept + 0.05)
        if made is not octree:
            near(f"{way}, largest of these over the RMS force", most, np.median(largest), 0.15)
    unshaded, shaded, sizes = mesh_errors(40)
    for law, own in (("none", unshaded), ("barycentric", shaded)):
        for family in ("direct f64", "god-object f64"):
            way = f"mesh, 16 cells, {law}: {family}"
            against(f"{way}, direction, deg", way, "direction_rms_deg", own, 0.1)
            near(f"{way}, median error of its size", number(ways, "size_median_1", way=way), np.median(sizes), 0.15)


# The largest stable stiffness of a hand's sampled loop.

def check_loops(limits, kinds, presses):
    """loop_limits.csv, each row at its own place, and walls; loop_kinds.csv and loop_presses.csv by bisection."""
    force_at = own_surfaces()
    by_hand = {}
    for row in (row for row in limits if row["limit_N_per_m"]):
        at = place_of(row)[None]
        force = force_at(row["surface"], at[0], 1e-3 * float(row["depth_mm"]))
        row["slope"], row["force"] = slope_of(force, at), unit(force(at))[0]
        row["along"] = {"on all sides": np.zeros(3), "down": np.eye(3)[2]}.get(row["hold"], row["force"])
        row["limit"] = float(row["limit_N_per_m"])
        hand = [float(row[name]) for name in ("damping_N_s_per_m", "grip_N_per_m", "rate_Hz")]
        by_hand.setdefault((*hand[:2], 1 / hand[2], int(row["delay_samples"])), []).append(row)
    off, wall_off, count = 0, 0, 0
    for hand, rows in by_hand.items():
        grows = loop_growth([row["slope"] for row in rows], [row["along"] for row in rows], *hand)
        limit = np.array([row["limit"] for row in rows])
        off += (~grows(1.0005 * limit)).sum() + sum(grows(s * limit).sum() for s in (0.3, 0.6, 0.9, 0.97, 0.9995))
        wall = least_growing(loop_growth([np.diag([0.0, 0, 1])], [[0, 0, 1]], *hand), 4 * hand[0] / hand[2])
        wall_off = max(wall_off, *(abs(wall / float(row["wall_N_per_m"]) - 1) for row in rows))
        count += len(rows)
    check(f"{count} limits: how many are not where loops begin to grow", 0, off, 0, 0)
    check(f"K_crit of {len(by_hand)} hands: largest difference over it", 0, wall_off, 0, 1e-5)
    own = next(hand for hand, rows in by_hand.items() if rows[0]["hand"] == "own")
    worst = lambda *words: min((row for row in by_hand[own] if (row["surface"], row["kind"]) == words),
                               key=lambda row: row["limit"])
    for kind in kinds:
        name, which = kind["surface"], kind["kind"]
        row = worst(name, which)
        near(f"{name}, {which}: limit, N/m", float(kind["limit_N_per_m"]),
             least_growing(loop_growth([row["slope"]], [row["along"]], *own), 12000), 5e-4)
    wall = least_growing(loop_growth([np.diag([0.0, 0, 1])], [[0, 0, 1]], *own), 12000)
    for name, formula, found in (
            ("bump of 2 facets", "K_crit times the cosine of a facet's slope",
             wall / math.hypot(1, facets_at(0.001, 2, TIGHT)[1])),
            ("shaded bump of 2 facets", "k_g (R^2 - x^2) / (R d) at the foot",
             500 * (TIGHT**2 - HALF**2) / (TIGHT * DEEPEST))):
        table = number(kinds, "limit_N_per_m", surface=name, kind="slope")
        near(f"{name}, {formula}, N/m", table, found, 2e-3)
    turned_by = lambda degrees: np.stack([np.sin(np.radians(degrees)), 0 * degrees, np.cos(np.radians(degrees))], 1)
    row, along = worst("shaded bump of 2 facets", "slope"), turned_by(np.arange(-120, 120, 0.1))
    held = np.minimum(along @ row["force"], ((along @ row["slope"]) * along).sum(1)) >= 0.2  # of what holds a press
    near("shaded bump of 2 facets, any press: limit, N/m", float(row["any_press_N_per_m"]), least_growing(
        loop_growth(np.tile(row["slope"], (held.sum(), 1, 1)), along[held], *own), 2000), 0.01)
    for name in ("bump of 2 facets", "shaded bump of 2 facets"):
        some = [press for press in presses if press["surface"] == name]
        at = 1e-3 * np.array([[float(some[0]["x_mm"]), 0, 0]])
        at[:, 2] = facets_at(at[:, 0], 2, TIGHT)[0] - DEEPEST
        slope, off = slope_of(force_at(name, at[0], DEEPEST), at), []
        for side in (-1, 1):  # the table does not say to which
            along = turned_by(side * np.array([float(press["press_deg"]) for press in some]))
            off.append(max(abs(least_growing(loop_growth([slope], [one], *own), 12000) - float(press["limit_N_per_m"]))
                           for one, press in zip(along, some)))
        check(f"{name}, {len(some)} presses: largest difference of limits, N/m", 0, min(off), 0, 1)


def check_tessellations(rows, own):
    """loop_tessellations.csv: each limit at its own place of a mesh that is drawn as the studies draw it."""
    shadings, off = {"mesh": "none", "shaded mesh": "barycentric"}, []
    for number in "1234":
        patch, some = Patch(TIGHT, 8, 0.025, splitmix(int(number))), [r for r in rows if r["tessellation"] == number]
        laws = [shadings.get(row["surface"], row["surface"].split()[0]) for row in some]
        flat, depth = ([[1e-3 * float(row[name]) for name in names] for row in some]
                       for names in (("x_mm", "y_mm"), ("depth_mm",)))
        low, high = np.full((2, len(some)), [[-0.02], [0.02]])
        for _ in range(50):  # down to where the force is K times the depth
            at = np.column_stack([flat, (low + high) / 2])
            far = patch.distances(at)
            faces = far.argmin(1)
            found = [size(patch.force_from(*which)(place[None])) for *which, place in zip(faces, laws, at)]
            under = (np.array(found) > depth)[:, 0] & ((at * patch.normals[faces]).sum(1) < patch.offsets[faces])
            low, high = np.where(under, [at[:, 2], high], [low, at[:, 2]])
        for row, law, place, apart in zip(some, laws, at[:, None], far):
            limits = []
            for face in np.flatnonzero(apart < apart.min() + 1e-9):  # two at a hollow edge
                force = patch.force_from(face, law)
                slopes, holds = [slope_of(force, place)] * 2, [unit(force(place))[0], [0, 0, 1]]
                limits.append(least_growing(loop_growth(slopes, holds, *own), 12000))
            off.append(min(abs(limit / float(row["limit_N_per_m"]) - 1) for limit in limits))
    check(f"{len(off)} limits on four further tessellations: largest difference over it", 0, max(off), 0, 5e-4)


# The energy gained round closed strokes, by the force's line integral.

def drawn_strokes(count, draws, reach):
    """Of strokes from and to (x, y), m, and their depths out and back, m; up to `reach`, m, either way."""
    strokes = []
    while len(strokes) < count:
        xa, ya, xb, yb, deep, back = (next(draws) for _ in range(6))
        begin, way = (np.array(part) * 2 * np.array(reach) for part in ((xa - 0.5, ya - 0.5), (xb - xa, yb - ya)))
        if size(way) >= max(reach) / 2:
            strokes.append((begin, way, DEEPEST * 10**-deep, DEEPEST * 10**-back))
    return strokes


def closed(strokes, heights):
    """m: corners of strokes out at one depth below a surface, back at another, each in 256 steps."""
    out = np.linspace(0, 1, 257)
    share = np.concatenate([out, np.ones(31), out[::-1], np.zeros(32)])
    deeper = np.concatenate([0 * out, out[8:-1:8], out**0, out[-9::-8]])
    return np.array([np.column_stack([begin + share[:, None] * way, heights(begin, way, share) - deep - deeper * (
        back - deep)]) for begin, way, deep, back in strokes])


def worked(places, forces_at, parts):
    """mJ: of each of some laws the work round strokes, either way, and the sum of its parts' sizes; K = 1000 N/m."""
    steps, work, effort = np.diff(places, axis=1) / parts, 0, 0
    for part in range(parts):
        done = (np.array(forces_at(places[:, :-1] + (part + 0.5) * steps)) * steps).sum(-1)
        work, effort = work + done.sum(-1), effort + abs(done).sum(-1)
    return 1e6 * abs(work), 1e6 * effort


def on_bump(count, draws, facets, scheme, parts):
    """worked() on strokes over a bump."""
    places = closed(drawn_strokes(count, draws, (HALF, 0.005)), lambda begin, way, share: facets_at(
        begin[0] + share * way[0], facets, TIGHT)[0])
    return worked(places, lambda at: bump_force(at, facets, TIGHT, "unshaded" not in scheme, "normal" in scheme), parts)


def on_meshes(cells, shadings):
    """mJ: of each shading the work round 250 strokes, which take turns with 25 meshes."""
    work, strokes = [], drawn_strokes(250, splitmix(3), (0.0105, 0.008))
    for draw in range(25):
        patch, casts = Patch(TIGHT, cells, 0.025, splitmix(1000 * draw + cells)), np.linspace(0, 1, 65)
        places = closed(strokes[draw::25], lambda begin, way, share: np.interp(
            share, casts, patch.heights(begin + casts[:, None] * way)))
        work.append(worked(places, lambda at: np.reshape(
            patch.forces(shadings, at.reshape(-1, 3)), (len(shadings), *at.shape)), 2)[0])
    return np.concatenate(work, 1)


def check_energy(rows):
    """energy.csv: medians over the study's strokes, and over others."""
    gains = {}
    for facets, scheme in ((1, "shaded"), (2, "shaded"), (8, "unshaded"), (8, "shaded"), (8, "shaded, normal depth"),
                           (512, "shaded")):
        words = {"surface": "bump", "elements": str(facets), "scheme": scheme}
        name = f"bump of {facets} facets, {scheme}"
        gain, effort = on_bump(250, splitmix(3), facets, scheme, 16)
        gains[facets, scheme] = gain
        near(f"{name}: gain, mJ", number(rows, "gain_mJ", **words), np.median(gain), 0.01)
        near(f"{name}: effort, mJ", number(rows, "effort_mJ", **words), np.median(effort), 0.005)
    more = number(rows, "more_mJ", surface="bump", elements="8", scheme="shaded")
    near("bump of 8 facets: gain by shading, mJ", more, np.median(gains[8, "shaded"] - gains[8, "unshaded"]), 0.01)
    others = iter(np.random.default_rng(4).random(10**5))
    gain, _ = on_bump(800, others, 8, "shaded", 4)
    table, low, high = (number(rows, f"gain{end}_mJ", surface="bump", elements="8", scheme="shaded")
                        for end in ("", "_from", "_to"))
    check("bump of 8 facets, shaded: gain over other strokes, mJ", table, np.median(gain), low, high)


    for cells, shadings in ((4, ("mean_value", "two_pass", "morgenbesser")), (16, ("mean_value", "two_pass"))):
        for shading, gain in zip(shadings, on_meshes(cells, shadings)):
            words = {"surface": "mesh", "elements": str(cells), "scheme": shading, "felt": "by the place"}
            near(f"mesh of {cells} x {cells} cells, {shading}: gain, mJ", number(rows, "gain_mJ", **words),
                 np.median(gain), 0.06)  # morgenbesser has the largest jumps between places


# Strokes of a hand in closed loop: how far a slower loop is from an ever faster one.

def stroked(speeds, reach, top, force_at, rate):
    """m: where the probe is each millisecond from 0.6 to 1.2 s of strokes of some speeds, m/s, there and back up to
    `reach`, m, from the middle, under a press of 1 N; a grip of 500 N/m and 2 N s/m, a device of 1 N s/m."""
    count, every = round(1.2 * rate) + 1, round(rate / 1000)
    across, upright = axis_steps(3, 500, 1 / rate), axis_steps(3, 0, 1 / rate)
    target = reach * (1 - 4 * abs(np.outer(np.arange(count + 1) / rate, speeds / (4 * reach)) % 1 - 0.5))
    x, z, along, up, kept = target[0], top + 0 * speeds, 0 * speeds, 0 * speeds, []
    for i in range(count):
        fx, fz = force_at(x, z)
        if i % every == 0 and i >= 600 * every:
            kept.append((x, z))
        off, push, down = x - target[i], fx + 2 * (target[i + 1] - target[i]) * rate, fz - 1
        x, along = (row[0] * off + row[1] * along + row[2] * push for row in across)
        x = x + target[i]
        z, up = z + upright[0, 1] * up + upright[0, 2] * down, upright[1, 1] * up + upright[1, 2] * down
    return np.moveaxis(np.array(kept), 1, 0)


def check_rates(rows):
    """loop_rates.csv, of other strokes; the fine mesh is taken for the cylinder."""
    speeds = np.random.default_rng(5).normal(0.06, 0.015, 48)
    foot = math.sqrt(TIGHT**2 - HALF**2)
    ends = TIGHT * np.sin(math.asin(HALF / TIGHT) * np.linspace(-1, 1, 65))
    tops = circle_height(ends, TIGHT)

    def on_bump(x, z):
        depth, sine = 1000 * np.maximum(np.interp(x, ends, tops) - z, 0), np.where(abs(x) < HALF, x / TIGHT, 0)
        return depth * sine, depth * np.sqrt(1 - sine**2)

    def on_cylinder(x, z):
        share = 1000 * np.maximum(TIGHT / np.hypot(x, z + foot) - 1, 0)
        return share * x, share * (z + foot)
    for name, reach, top, force_at in (("bump", 1.2 * HALF, 0, on_bump), ("mesh", HALF / 2, TIGHT - foot, on_cylinder)):
        def forces(places):
            return np.moveaxis(np.array(force_at(*places)), 0, -1)

        def at_rate(rate):
            return stroked(speeds, reach, top, force_at, 1000 * rate)
        limit, errors = forces(2 * at_rate(64) - at_rate(32)), {}
        for rate in (1, 2, 4, 8):
            off = size(forces(at_rate(rate)) - limit) / rms(size(limit))
            words = {"surface": name, "precision": "f64", "rate_kHz": str(rate)}
            errors[rate] = number(rows, "median_error_1", **words)
            near(f"{name}, loop of {rate} kHz: median error", errors[rate], np.median(off), 0.12)
            near(f"{name}, loop of {rate} kHz: RMS error", number(rows, "force_error_1", **words), rms(off), 0.2)
        near(f"{name}, error of 1 kHz over that of 8 kHz", errors[1] / errors[8], 8, 0.2)


def main():
    """The exit code."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--tables", type=pathlib.Path,
                        default=pathlib.Path(__file__).resolve().parents[2] / "results" / "reference")
    folder = parser.parse_args().tables

    def table(name):
        with open(folder / f"{name}.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))
    check_jumps(table("stability/worst_rounding"))
    check_errors(table("error-time/draws"), table("error-time/ways"))
    check_loops(*(table(f"stability/loop_{name}") for name in ("limits", "kinds", "presses")))
    check_tessellations(table("stability/loop_tessellations"), (3, 500, 1e-3, 0))
    check_couplings(table("stability/loop_couplings"), table("stability/loop_limits"))
    check_basins(table("stability/loop_basins"), table("stability/loop_limits"))
    check_edges(table("stability/loop_edges"))
    atlases = [study for study in ("stability", "stability-bump") if (folder / study / "loop_atlas.csv").exists()]
    check("tables of limits over one quantity", 1, len(atlases), 1, 2)
    for study in atlases:  # the scene is the README's bump.toml
        rows, limits = ([{**row, "surface": row["surface"].replace("scene", "shaded bump of 2 facets")}
                         for row in table(f"{study}/loop_{which}")] for which in ("atlas", "limits"))
        check_atlas(rows, limits, study)
        check_rounded(rows, study)
    check_perception(table("perception/answers"), table("perception/facets"))
    check_energy(table("energy/energy"))
    check_rates(table("error-time/loop_rates"))
    print(outcomes.count(False), "off")
    return int(not all(outcomes))


if __name__ == "__main__":
    sys.exit(main())
