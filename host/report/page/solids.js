// Shapes that are drawn in space, in mm: sheets of heights, the boundary of a field, arrows, words.

const MM = 1e3;

function solid(positions, index) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.setIndex(index);
  geometry.computeVertexNormals();
  return geometry;
}

// Heights over x and y (host/report/space_data.h); one row of heights stands for every y from `low` to `high` (m).
function sheetSolid({ unit_m, x, z }, [low, high]) {
  const rows = z.length > 1 ? z : [z[0], z[0]], positions = [], index = [], n = x.length;
  rows.forEach((heights, row) => heights.forEach((height, i) => {
    positions.push(MM * unit_m * x[i], MM * (low + row / (rows.length - 1) * (high - low)), MM * unit_m * height);
    if (row > 0 && i > 0)
      index.push((row - 1) * n + i - 1, (row - 1) * n + i, row * n + i, (row - 1) * n + i - 1, row * n + i, row * n + i - 1);
  }));
  return solid(positions, index);
}

// Where a field ends, of a case whose surface is not at hand: a vertex in each cell of the grid that has samples with force
// and without, in the middle of the crossings of its edges (naive surface nets). A force of a stiffness tells how far its
// sample is from the surface.
function boundarySolid(volume_, stiffness) {
  const size = volume_.size.map((n) => Math.max(n, 2)), positions = [], index = [], vertices = new Map();
  const place = (at) => at.map((i, a) => volume_.size[a] > 1 ? volume_.position(a, i) : volume_.edges(a)[i]);
  const force = (at) => volume_.sample(at.map((i, a) => Math.min(i, volume_.size[a] - 1)));
  const key = (at) => at[0] + size[0] * (at[1] + size[1] * at[2]);
  const moved = (at, axis, by) => at.map((i, a) => a === axis ? i + by : i);
  const inside = new Uint8Array(size[0] * size[1] * size[2]), at = [0, 0, 0];
  const each = (sizes, visit) => {
    for (at[2] = 0; at[2] < sizes[2]; ++at[2])
      for (at[1] = 0; at[1] < sizes[1]; ++at[1])
        for (at[0] = 0; at[0] < sizes[0]; ++at[0])
          visit();
  };
  each(size, () => { inside[key(at)] = length(force(at)) > 0; });
  const crossing = (one, other, axis) => {
    const within = inside[key(one)] ? one : other, f = force(within), [from, to] = [within, within === one ? other : one].map(place);
    const part = stiffness ? length(f) ** 2 / stiffness / Math.max(Math.abs(f[axis] * (to[axis] - from[axis])), 1e-12) : 0.5;
    return from.map((value, a) => value + Math.min(part, 1) * (to[a] - value));
  };
  each(size.map((n) => n - 1), () => {
    const sum = [0, 0, 0];
    let count = 0;
    for (let axis = 0; axis < 3; ++axis)
      for (let edge = 0; edge < 4; ++edge) {
        const low = moved(moved(at, (axis + 1) % 3, edge & 1), (axis + 2) % 3, edge >> 1), high = moved(low, axis, 1);
        if (inside[key(low)] !== inside[key(high)]) {
          crossing(low, high, axis).forEach((value, a) => { sum[a] += value; });
          ++count;
        }
      }
    if (count) {
      vertices.set(key(at), positions.length / 3);
      positions.push(...sum.map((value) => MM * value / count));
    }
  });
  each(size, () => {
    for (let axis = 0; axis < 3; ++axis) {
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3], next = moved(at, axis, 1);
      if (next[axis] >= size[axis] || inside[key(at)] === inside[key(next)] || !at[u] || !at[v])
        continue;
      const corners = [moved(moved(at, u, -1), v, -1), moved(at, v, -1), at, moved(at, u, -1)].map((cell) => vertices.get(key(cell)));
      if (corners.every((corner) => corner !== undefined)) {
        const [a, b, c, d] = inside[key(at)] ? corners : corners.reverse();
        index.push(a, b, c, a, c, d);
      }
    }
  });
  return solid(positions, index);
}

// Of length 1 along y, as thick as `width`.
const arrowSolid = (width) => new THREE.LatheBufferGeometry([[0, 0], [0.35, 0], [0.35, 0.7], [1, 0.7], [0, 1]]
  .map(([radius, y]) => new THREE.Vector2(radius * width, y)), 10);

// Where an arrow of that vector stands (mm both), for a mesh with an arrow's geometry.
function arrowMatrix(from, vector, thickness) {
  const size = length(vector), direction = new THREE.Vector3(...vector).normalize();
  return new THREE.Matrix4().compose(new THREE.Vector3(...from), new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), direction),
    new THREE.Vector3(thickness, size, thickness));
}

// A word that faces who looks, so many mm high.
function wordSprite(text, height, colour) {
  const canvas = document.createElement("canvas"), context = canvas.getContext("2d"), font = "28px system-ui, 'DejaVu Sans', sans-serif";
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 8;
  canvas.height = 40;
  Object.assign(context, { font, fillStyle: colour, textBaseline: "middle" });
  context.fillText(text, 4, 20);
  const map = new THREE.CanvasTexture(canvas);
  map.minFilter = THREE.LinearFilter;
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map, depthTest: false }));
  sprite.scale.set(height * canvas.width / canvas.height, height, 1);
  return sprite;
}
