// Shapes that are drawn in space, in mm: sheets of heights, the boundary of a field, arrows, words.

const MM = 1e3;

// A geometry of vertices: {position: [x, y, z, ...], and perhaps uv, color}.
function geometryOf(index, attributes) {
  const geometry = new THREE.BufferGeometry();
  for (const [name, values] of Object.entries(attributes))
    geometry.setAttribute(name, new THREE.Float32BufferAttribute(values, name === "uv" ? 2 : 3));
  geometry.setIndex(index);
  return geometry;
}

function solid(position, index) {
  const geometry = geometryOf(index, { position });
  geometry.computeVertexNormals();
  return geometry;
}

// Heights over x and y (host/report/sections.h); one row of heights stands for every y from `low` to `high` (m).
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
// and without, in the middle of the crossings of its edges (naive surface nets). The force divided by the stiffness is
// the distance of its sample from the surface.
function boundarySolid(volume_, stiffness) {
  const size = volume_.size.map((n) => Math.max(n, 2)), strides = [1, size[0], size[0] * size[1]], at = [0, 0, 0];
  const positions = [], index = [], inside = new Uint8Array(strides[2] * size[2]), vertices = new Int32Array(inside.length).fill(-1);
  const force = (one) => volume_.sample(one.map((i, a) => Math.min(i, volume_.size[a] - 1)));
  const place = (one) => one.map((i, a) => volume_.size[a] > 1 ? volume_.position(a, i) : volume_.edges(a)[i]);
  const each = (less, visit) => { // of the samples, or of the cells, one less along each axis
    for (at[2] = 0; at[2] < size[2] - less; ++at[2])
      for (at[1] = 0; at[1] < size[1] - less; ++at[1])
        for (at[0] = 0; at[0] < size[0] - less; ++at[0])
          visit(at[0] + strides[1] * at[1] + strides[2] * at[2]);
  };
  const [nx, ny, nz] = volume_.about.size, [fx, fy, fz] = volume_.components;
  each(0, (n) => {
    const i = Math.min(at[0], nx - 1) + nx * (Math.min(at[1], ny - 1) + ny * Math.min(at[2], nz - 1));
    inside[n] = fx[i] !== 0 || fy[i] !== 0 || fz[i] !== 0;
  });
  const corners = d3.range(8).map((c) => [c & 1, c >> 1 & 1, c >> 2]), offsets = corners.map((c) => d3.sum(c, (on, a) => on * strides[a]));
  const crossing = (within, without, axis) => {
    const f = force(within), [from, to] = [place(within), place(without)], step = Math.abs(to[axis] - from[axis]);
    const part = stiffness ? length(f) ** 2 / stiffness / Math.max(Math.abs(f[axis]) * step, 1e-12) : 0.5;
    return from.map((value, a) => value + Math.min(part, 1) * (to[a] - value));
  };
  each(1, (n) => {
    let count = 0;
    for (let c = 0; c < 8; ++c)
      count += inside[n + offsets[c]];
    if (count === 0 || count === 8)
      return;
    const found = [];
    corners.forEach((corner, c) => corner.forEach((on, axis) => {
      const other = c | 1 << axis, ends = [corner, corners[other]].map((one) => one.map((up, a) => at[a] + up));
      if (!on && inside[n + offsets[c]] !== inside[n + offsets[other]])
        found.push(inside[n + offsets[c]] ? crossing(ends[0], ends[1], axis) : crossing(ends[1], ends[0], axis));
    }));
    vertices[n] = positions.length / 3;
    positions.push(...[0, 1, 2].map((a) => MM * d3.mean(found, (one) => one[a])));
  });
  each(0, (n) => strides.forEach((stride, axis) => {
    if (inside[n] === inside[n + stride] || at[axis] + 1 >= size[axis])
      return;
    const u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (!at[u] || !at[v])
      return;
    const round = [n - strides[u] - strides[v], n - strides[v], n, n - strides[u]].map((cell) => vertices[cell]);
    const [a, b, c, d] = inside[n] ? round : round.reverse();
    if (Math.min(...round) >= 0)
      index.push(a, b, c, a, c, d);
  }));
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

// A word that faces the viewer; its height in mm.
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
