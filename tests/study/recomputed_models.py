"""Shapes and loops of recomputed.py: the bump of facets, a convex block of triangles, a hand's sampled loop.

Lengths are in m; forces are over K, in m.
"""
import math
import numpy as np

HALF, TIGHT, WIDE = 0.0127, 0.01524, 0.0254  # m: half the bump's width, the radii of the studies
MASS = 0.1  # kg: of a hand


def size(vectors):
    """Lengths."""
    return np.linalg.norm(vectors, axis=-1)


def unit(vectors):
    """Vectors over their lengths."""
    return vectors / size(vectors)[..., None]


def angles(one, other):
    """deg: between vectors."""
    return np.degrees(2 * np.arctan2(size(unit(one) - unit(other)), size(unit(one) + unit(other))))


def rms(values):
    """Root mean square."""
    return math.sqrt(np.mean(np.square(values)))


# The bump of facets between equal arcs of a cylinder.

def circle_height(x, radius):
    """m: of the cylinder above the plane, 0 beyond it."""
    return np.where(abs(x) < HALF, np.sqrt(np.maximum(radius**2 - x**2, 0)) - math.sqrt(radius**2 - HALF**2), 0)


def round_normals(x, radius):
    """Of the cylinder above or below x, straight up beyond it."""
    sine = np.where(abs(x) < HALF, x / radius, 0)
    return np.stack([sine, 0 * sine, np.sqrt(1 - sine**2)], -1)


def facets_at(x, facets, radius):
    """m, 1: height and slope of the facets above or below x."""
    ends = radius * np.sin(math.asin(HALF / radius) * np.linspace(-1, 1, facets + 1))
    tops = circle_height(ends, radius)
    which = np.clip(np.searchsorted(ends, x, "right") - 1, 0, facets - 1)
    return np.interp(x, ends, tops), np.where(abs(x) < HALF, (np.diff(tops) / np.diff(ends))[which], 0)


def bump_force(at, facets, radius, shaded, normal_depth=False):
    """m: the depth under the facets, straight up or along their normal, along the facets' or the cylinder's normal."""
    height, slope = facets_at(at[..., 0], facets, radius)
    flat = np.stack([-slope, 0 * slope, 1 + 0 * slope], -1) / np.sqrt(1 + slope**2)[..., None]
    depth = np.maximum(height - at[..., 2], 0) * (flat[..., 2] if normal_depth else 1)
    return depth[..., None] * (round_normals(at[..., 0], radius) if shaded else flat)


def splitmix(seed):
    """Uniform numbers below 1 (Steele, Lea & Flood 2014), from which the studies draw."""
    while True:
        seed = word = (seed + 0x9E3779B97F4A7C15) % 2**64
        for shift, times in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB), (31, 1)):
            word = (word ^ (word >> shift)) * times % 2**64
        yield (word >> 11) / 2**53


class Triangles:
    """A surface of plane faces, each of some triangles."""

    def __init__(self, vertices, faces):
        self.vertices, self.faces = vertices, [np.array(face) for face in faces]
        first = np.array([vertices[face[0]] for face in self.faces])
        self.normals = unit(np.cross(first[:, 1] - first[:, 0], first[:, 2] - first[:, 0]))
        self.offsets = (self.normals * first[:, 0]).sum(1)
        sums = np.zeros_like(vertices)
        for face, normal in zip(self.faces, self.normals):
            np.add.at(sums, face.ravel(), normal)
        self.vertex_normals = unit(sums)  # each triangle counts alike

    def weights(self, corners, at):
        """Barycentric, of points of triangles' planes."""
        a, b, c = (self.vertices[corners[..., k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        two = [(np.cross(e, at - p) * normal).sum(-1) / (normal**2).sum(-1) for e, p in ((c - b, b), (a - c, c))]
        return np.stack([*two, 1 - two[0] - two[1]], -1)

    def located(self, face, at):
        """Of points of a face, the triangles that they lie in."""
        inside = self.weights(self.faces[face][None], at[:, None]).min(-1)
        return self.faces[face][inside.argmax(1)]

    def force(self, shading, corners, at, normal, depth):
        """m: where the nearest points of the surface are these of triangles."""
        around = self.vertex_normals[corners]
        if shading == "none":
            return depth * np.broadcast_to(normal, at.shape)
        if shading == "morgenbesser":
            far = size(self.vertices[corners] - at[:, None])
            return depth * unit((far[..., None] * (around.sum(1, keepdims=True) - around)).sum(1))
        direction = unit((self.weights(corners, at)[..., None] * around).sum(1))  # mean_value, too: of triangles
        return depth * direction / ((direction * normal).sum(-1, keepdims=True) if shading == "two_pass" else 1)

    def force_under(self, face, shading):
        """A force, m, at places under a face."""
        def force(at):
            depth = self.offsets[face] - at @ self.normals[face]
            foot = at + depth[:, None] * self.normals[face]
            return depth[:, None] * self.force(shading, self.located(face, foot), foot, self.normals[face], 1)
        return force


class Block(Triangles):
    """A convex block: its top a cylinder of cells x rows over 2 a, its other faces fans."""

    def __init__(self, radius, cells, rows):
        half = math.asin(HALF / radius)
        columns = cells + 2 * max(1, round((min(1.5 * half, 1.25) - half) * cells / (2 * half)))
        turn = 2 * half / cells * (np.arange(columns + 1) - columns / 2)
        x, z = radius * np.sin(turn), radius * np.cos(turn) - math.sqrt(radius**2 - HALF**2)
        top = [np.repeat(x, rows + 1), np.tile(np.linspace(-HALF, HALF, rows + 1), columns + 1), np.repeat(z, rows + 1)]
        floor = [[sx * x[-1], sy * HALF, -4 * HALF] for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        low, at = len(top[0]), lambda i, j: i * (rows + 1) + j
        fan = lambda p: [(p[0], p[k], p[k + 1]) for k in range(1, len(p) - 1)]
        faces = [sum((fan([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]) for j in range(rows)), [])
                 for i in range(columns)]
        faces += map(fan, [[low, low + 1, *(at(i, 0) for i in range(columns, -1, -1))],
                           [low + 1, low + 2, *(at(columns, j) for j in range(rows, -1, -1))],
                           [low + 2, low + 3, *(at(i, rows) for i in range(columns + 1))],
                           [low + 3, low, *(at(0, j) for j in range(rows + 1))], [low + 3, low + 2, low + 1, low]])
        super().__init__(np.vstack([np.stack(top, 1), floor]), faces)

    def under_ridges(self, depth, count):
        """Of each two faces, `count` points that lie `depth` under both and no less deep under the others."""
        for i, j in ((i, j) for i in range(len(self.faces)) for j in range(i)):
            along = np.cross(self.normals[i], self.normals[j])
            if size(along) < 1e-9:
                continue
            on = np.linalg.solve([self.normals[i], self.normals[j], along],
                                 [self.offsets[i] - depth, self.offsets[j] - depth, 0])
            room, rise = np.delete([self.offsets - depth - self.normals @ on, self.normals @ along], [i, j], 1)
            begin = max(r / s for r, s in zip(room, rise) if s < -1e-12)
            end = min(r / s for r, s in zip(room, rise) if s > 1e-12)
            if begin < end and (room[abs(rise) < 1e-12] >= 0).all():
                yield i, j, on + np.linspace(begin, end, count)[:, None] * along

    def jumps_within(self, shading, depth):
        """m: the largest jump under edges between triangles of one face."""
        most = 0.0
        for face, normal in zip(self.faces, self.normals):
            sides = {}
            for triangle in face:
                for edge in zip(triangle, np.roll(triangle, 1)):
                    sides.setdefault(tuple(sorted(edge)), []).append(triangle)
            pairs = [(*edge, *both) for edge, both in sides.items() if len(both) == 2]
            begin, end, one, other = (np.array(column) for column in zip(*pairs))
            for share in np.linspace(0.1, 0.9, 9):
                foot = (1 - share) * self.vertices[begin] + share * self.vertices[end]
                deep = (self.offsets - (foot - depth * normal) @ self.normals.T >= depth - 1e-12).all(1)
                forces = [self.force(shading, c[deep], foot[deep], normal, depth) for c in (one, other)]
                most = max(most, size(forces[0] - forces[1]).max(initial=0))
        return most

    def jump_at(self, shading, at):
        """m: between the forces of all triangles that are nearest at a place, but for rounding."""
        depths, forces = self.offsets - self.normals @ at, []
        for face in np.flatnonzero(depths < depths.min() + 1e-8):
            foot = (at + depths[face] * self.normals[face])[None]
            for triangle in self.faces[face][self.weights(self.faces[face], foot).min(-1) > -1e-4]:
                forces.append(self.force(shading, triangle[None], foot, self.normals[face], depths[face])[0])
        return max(size(one - other) for one in forces for other in forces)


class Patch(Triangles):
    """An open cylinder of cells x cells over 2 a, turned and moved by draws."""

    def __init__(self, radius, cells, reach, draws):
        cell = 2 * np.array([radius * math.asin(HALF / radius), HALF]) / cells
        self.counts = 2 * np.ceil(reach / cell).astype(int)
        (columns, rows), self.cell, self.radius = self.counts, cell, radius
        self.moved, self.spin = [next(draws), next(draws)], turned(2 * math.pi * next(draws), 2)[:2, :2]
        grid = np.stack(np.meshgrid(np.arange(columns + 1), np.arange(rows + 1), indexing="ij"), -1).reshape(-1, 2)
        flat = ((grid - self.counts / 2 + self.moved) * cell) @ self.spin.T
        turn, at = flat[:, 0] / radius, lambda i, j: i * (rows + 1) + j
        self.centre = -math.sqrt(radius**2 - HALF**2)  # m: along z
        super().__init__(
            np.stack([radius * np.sin(turn), flat[:, 1], radius * np.cos(turn) + self.centre], 1),
            [[(at(i, j), *last)] for i in range(columns) for j in range(rows)
             for last in ((at(i + 1, j), at(i + 1, j + 1)), (at(i + 1, j + 1), at(i, j + 1)))])
        self.corners = np.array(self.faces)[:, 0]

    def faces_near(self, turn, y):
        """Of places under angles, and y, m, the 18 faces of the cells about them."""
        cells = (np.stack([self.radius * turn, y], -1) @ self.spin) / self.cell + self.counts / 2 - self.moved
        i, j = (np.floor(cells)[:, None] + list(np.ndindex(3, 3)) - 1).astype(int).transpose(2, 0, 1)
        return np.concatenate([2 * (i * self.counts[1] + j) + k for k in (0, 1)], 1)

    def heights(self, flat):
        """m: above places (x, y)."""
        near = self.faces_near(np.arcsin(flat[:, 0] / self.radius), flat[:, 1])
        a, b, c = (self.vertices[self.corners[near][..., k]][..., :2] for k in range(3))
        cross = lambda u, v: u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
        inside = np.min([cross(q - p, flat[:, None] - p) for p, q in ((a, b), (b, c), (c, a))], 0)
        face = np.take_along_axis(near, inside.argmax(1)[:, None], 1)[:, 0]
        return (self.offsets[face] - (self.normals[face][:, :2] * flat).sum(1)) / self.normals[face][:, 2]

    def forces(self, shadings, at):
        """m: by shading, at places below it."""
        near = self.faces_near(np.arctan2(at[:, 0], at[:, 2] - self.centre), at[:, 1])
        feet = nearest_on(self.vertices[self.corners[near]], at)[0]
        first = size(feet - at[:, None]).argmin(1)[:, None]
        face, foot = np.take_along_axis(near, first, 1)[:, 0], np.take_along_axis(feet, first[..., None], 1)[:, 0]
        return [self.force(shading, self.corners[face], foot, self.normals[face], 1) * size(foot - at)[:, None]
                for shading in shadings]

    def feet(self, faces, at):
        """The points of faces, one triangle each, nearest to places."""
        return nearest_on(self.vertices[np.array([self.faces[face][0] for face in faces])][None], at)[0]

    def distances(self, at):
        """Of places those to all faces."""
        return size(self.feet(range(len(self.faces)), at) - at[:, None])

    def force_from(self, face, shading):
        """A force, m, where the nearest point is one of a face."""
        def force(at):
            foot = self.feet([face], at)[:, 0]
            out = foot - at
            if shading == "none":
                return out
            return self.force(shading, self.faces[face], foot, self.normals[face], 1) * size(out)[:, None]
        return force


def nearest_on(triangles, at):
    """Of triangles (n, m, corners, 3) the points nearest to n places, and the triangles' normals."""
    a, b, c = (triangles[:, :, k] for k in range(3))
    normal, at = unit(np.cross(b - a, c - a)), at[:, None]
    foot = at - ((at - a) * normal).sum(-1, keepdims=True) * normal
    within, edges = True, []
    for p, q in ((a, b), (b, c), (c, a)):
        within &= (np.cross(q - p, foot - p) * normal).sum(-1) >= 0
        share = np.clip(((at - p) * (q - p)).sum(-1) / ((q - p)**2).sum(-1), 0, 1)
        edges.append(p + share[..., None] * (q - p))
    nearest = np.argmin([size(edge - at) for edge in edges], 0)[None, ..., None]
    return np.where(within[..., None], foot, np.take_along_axis(np.array(edges), nearest, 0)[0]), normal


def map_force(radius, side=1):
    """m: of a plane with a cylinder's normals, of a bump (1) or a dip (-1)."""
    return lambda at: np.maximum(-at[:, 2], 0)[:, None] * round_normals(at[:, 0], radius) * [side, 1, 1]


def textured_force(at):
    """m: of a plane with a sine of 10 um and 2 mm, as stiff as the plane."""
    depth, turns = np.maximum(-at[:, 2], 0), 2 * math.pi / 0.002
    return np.stack([-depth * 1e-5 * turns * np.cos(turns * at[:, 0]), 0 * depth, depth], -1)


def slope_of(force, at):
    """1: -dF/dp over K at a place, by differences."""
    step = 1e-8
    return np.stack([(force(at - step * e) - force(at + step * e))[0] / (2 * step) for e in np.eye(3)], -1)


def own_surfaces():
    """force_at(name, place, depth): of a studied surface the force, m, about there; of a mesh that of the face which is
    so far above, m, to which a god-object came and which need not be the nearest."""
    block, shadings = Block(TIGHT, 8, 8), {"mesh": "none", "shaded mesh": "barycentric"}
    surfaces = {"plane": map_force(math.inf), "textured plane": textured_force,
                "height map of a bump": map_force(WIDE), "height map of a dip": map_force(WIDE, -1)}
    for shaded in (False, True):
        for facets in (2, 8):
            name = ("shaded bump" if shaded else "bump") + f" of {facets} facets"
            surfaces[name] = lambda at, facets=facets, shaded=shaded: bump_force(at, facets, TIGHT, shaded)

    def force_at(name, at, depth):
        face = abs(block.offsets - block.normals @ at - depth).argmin()
        return surfaces.get(name) or block.force_under(face, shadings.get(name, name.split()[0]))
    return force_at


def turned(angle, axis):
    """A matrix that turns about z (2) or x (0)."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]] if axis == 2 else [[1, 0, 0], [0, c, -s], [0, s, c]])


def powered(rates):
    """exp(rates), of a matrix, by many small steps."""
    part = rates / 2**20
    return np.linalg.matrix_power(np.eye(len(part)) + part + part @ part / 2 + part @ part @ part / 6, 2**20)


def axis_steps(damping, spring, period, mass=MASS):
    """Over a sample, the rows of place and speed by place, speed and force (N s/m, N/m, s, kg, N)."""
    return powered(period * np.array([[0, 1, 0], [-spring / mass, -damping / mass, 1 / mass], [0, 0, 0]]))[:2]


def loop_growth(slopes, along, damping, grip, period, delay):
    """A function of stiffnesses, N/m, that says which loops grow. `slopes`, 1: -dF/dp over K, 3 x 3; `along`: a unit
    vector on which a constant force presses in place of the grip's spring; 0: none does."""
    slopes, along = np.asarray(slopes), np.asarray(along)
    pressed, count = along.any(1), 6 + 3 * delay
    last = np.where(pressed[:, None], along, [0, 0, 1])
    first = unit(np.cross(last, np.where(abs(last[:, :1]) < 0.5, [1, 0, 0], [0, 1, 0])))
    frame = np.stack([first, np.cross(last, first), last], -1)
    turned_slopes = np.swapaxes(frame, 1, 2) @ slopes @ frame
    steps = np.tile(axis_steps(damping, grip, period), (len(slopes), 3, 1, 1))
    steps[pressed, 2] = axis_steps(damping, 0, period)
    base = np.zeros((len(slopes), count, count))
    for i in range(3):
        base[:, [[i], [3 + i]], [i, 3 + i]] = steps[:, i, :, :2]
        if delay:  # of one sample
            base[:, [i, 3 + i], 6 + i] = steps[:, i, :, 2]

    def grows(stiffness):
        maps, forces = base.copy(), -np.reshape(stiffness, (-1, 1, 1)) * turned_slopes
        if delay:
            maps[:, 6:, :3] = forces
        else:
            maps[:, :3, :3] += steps[:, :, 0, 2, None] * forces
            maps[:, 3:, :3] += steps[:, :, 1, 2, None] * forces
        return abs(np.linalg.eigvals(maps)).max(1) > 1 + 1e-10
    return grows


def least_growing(grows, most):
    """N/m: where one loop begins to grow, by bisection."""
    low, high = 0, most
    for _ in range(30):
        low, high = ((low + high) / 2, high) if not grows((low + high) / 2).any() else (low, (low + high) / 2)
    return low
