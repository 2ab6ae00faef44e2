// Cases A and B in space, side by side: surface, slice, forces and paths. Both are turned, read and played alike.

const SPACE_HEIGHT = 420, SPACE_STACKED = 300, STACKED_BELOW = 640; // px
const ARROWS_ACROSS = 26, VIEW_ANGLE = 28; // deg

class Space {
  constructor(viewer) {
    this.viewer = viewer;
    this.canvas = byId("space");
    this.camera = new THREE.PerspectiveCamera(VIEW_ANGLE, 1, 1, 1e4);
    this.camera.up.set(0, 0, 1);
    this.ray = new THREE.Raycaster();
    this.nearer = new THREE.Plane(); // what is nearer than the slice is seen through
    this.farther = new THREE.Plane();
    this.playing = 0;
  }

  // Draws only once it is visible.
  start() {
    const context = this.canvas.getContext("webgl2", { antialias: true }) || this.canvas.getContext("webgl", { antialias: true });
    if (!context) {
      say("space-note", "This browser has no WebGL, so there is no view in 3D; the slices below show the same forces.");
      document.querySelectorAll("#space-box, #space-controls, #space-scales").forEach((one) => { one.hidden = true; });
      return;
    }
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, context });
    this.renderer.localClippingEnabled = true;
    this.renderer.setScissorTest(true);
    this.renderer.setPixelRatio(window.devicePixelRatio || 1);
    this.orbit = new THREE.OrbitControls(this.camera, this.canvas);
    Object.assign(this.orbit, { enableKeys: false, enableZoom: false }); // a page is scrolled until one has taken hold of it
    this.orbit.addEventListener("change", () => this.render());
    this.listen();
    this.load().catch((error) => say("space-note", "The view in 3D failed: " + error.message));
  }

  listen() {
    const { canvas, viewer } = this;
    let pressed = null;
    canvas.addEventListener("focus", () => { this.orbit.enableZoom = true; });
    canvas.addEventListener("blur", () => { this.orbit.enableZoom = false; });
    canvas.addEventListener("keydown", (event) => viewer.onKey(event));
    canvas.addEventListener("pointerdown", (event) => { pressed = [event.clientX, event.clientY]; });
    canvas.addEventListener("pointermove", (event) => event.buttons || this.pick(event));
    canvas.addEventListener("pointerup", (event) => pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 5 && this.pick(event));
    for (const id of ["path", "path-colour"])
      byId(id).addEventListener("change", () => this.drawPaths());
    byId("path-time").addEventListener("input", () => { this.stop(); this.drawProbe(); });
    byId("path-play").addEventListener("click", () => this.playing ? this.stop() : this.play());
    byId("space-home").addEventListener("click", () => this.lookFromHome());
    byId("space-png").addEventListener("click", () => { this.renderNow(); save("space.png", this.canvas.toDataURL("image/png")); });
    byId("space-csv").addEventListener("click", () => save("slice.csv", "data:text/csv;charset=utf-8," + encodeURIComponent(this.sliceText())));
  }

  // The viewer's two cases, or its one.
  shown() {
    const { a, b } = this.viewer;
    return a.about === b.about ? [a] : [a, b];
  }

  async load() {
    const { viewer } = this, { a, b } = viewer, shown = this.shown();
    const most = Math.max(...shown.map((one) => one.about.paths ? one.about.paths.size[1] : 0));
    byId("path").replaceChildren(...d3.range(most).map((i) => new Option(String(i + 1), i)));
    byId("path-fields").hidden = byId("path-scale").parentElement.hidden = byId("help-path").hidden = !most;
    byId("help-smooth").hidden = !shown.some(({ about }) => about.surface !== undefined && viewer.surfaces[about.surface].smooth);
    this.makeRoom(shown.length);
    if (!this.renderer)
      return;
    const walks = await Promise.all(shown.map((one) => paths(viewer.cases, viewer.cases.indexOf(one.about))));
    if (viewer.a !== a || viewer.b !== b)
      return;
    this.stop();
    (this.sides || []).forEach((side) => Object.keys(side.parts).forEach((name) => this.put(side, name))); // lets go of its memory
    this.sides = shown.map((volume_, i) => ({ name: "ab"[i], volume: volume_, paths: walks[i], scene: new THREE.Scene(), parts: {} }));
    const box = this.box = new THREE.Box3();
    for (const { volume: one } of this.sides)
      for (const end of [0, 1])
        box.expandByPoint(new THREE.Vector3(...[0, 1, 2].map((axis) => MM * one.edges(axis)[end])));
    const before = this.whole;
    this.whole = box.clone();
    this.radius = box.getSize(new THREE.Vector3()).length() / 2;
    byId("path-time").max = Math.max(0, ...this.sides.map((side) => side.paths ? side.paths.steps - 1 : 0));
    byId("path-time").value = 0;
    this.makeAll();
    this.sides.forEach((side) => ["surface", "frame"].forEach((part) => this.whole.expandByObject(side.parts[part])));
    if (!before || !before.equals(this.whole))
      this.lookFromHome();
    this.mark();
    document.documentElement.dataset.space = "ready";
  }

  // As near as the whole box can be seen.
  lookFromHome() {
    const { camera, whole, radius } = this, centre = whole.getCenter(new THREE.Vector3()), away = new THREE.Vector3(-0.45, -1, 0.62).normalize();
    const ends = [whole.min, whole.max];
    Object.assign(camera, { near: radius / 20, far: radius * 40, aspect: this.aspect() });
    camera.updateProjectionMatrix();
    for (let distance = 6 * radius, step = 0; step < 6; ++step) {
      camera.position.copy(centre).addScaledVector(away, distance);
      camera.lookAt(centre);
      camera.updateMatrixWorld();
      const corners = d3.range(8).map((i) => new THREE.Vector3(ends[i & 1].x, ends[i >> 1 & 1].y, ends[i >> 2].z).project(camera));
      distance *= 1.12 * d3.max(corners, (corner) => Math.max(Math.abs(corner.x), Math.abs(corner.y)));
    }
    this.orbit.target.copy(centre);
    this.orbit.update();
    this.render();
  }

  // The slice, the quantity, the cases or the page's colours changed: everything but the camera is made anew before the
  // next picture.
  draw() {
    this.stale = true;
    this.mark();
  }

  makeAll() {
    this.stale = false;
    this.colours = palette();
    for (const side of this.sides)
      for (const make of [this.makeLights, this.makeFrame, this.makeSurface, this.makeSlice])
        make.call(this, side);
    byId("space-title-a").textContent = "A: " + this.viewer.a.about.name;
    byId("space-title-b").textContent = this.sides.length > 1 ? "B: " + this.viewer.b.about.name : "";
    this.viewer.scale.draw(byId("space-scale"));
    this.drawPaths();
  }

  // Puts objects in the place of those of that name.
  put(side, name, ...objects) {
    if (side.parts[name]) {
      side.scene.remove(side.parts[name]);
      side.parts[name].traverse((one) => [one.geometry, one.material, one.material && one.material.map].forEach((held) => held && held.dispose()));
    }
    side.parts[name] = new THREE.Group();
    objects.forEach((one) => side.parts[name].add(one));
    side.scene.add(side.parts[name]);
  }

  makeLights(side) {
    side.sun = new THREE.DirectionalLight(0xffffff, 0.55);
    this.put(side, "lights", new THREE.HemisphereLight(0xffffff, 0x777777, 0.75), side.sun, side.sun.target);
  }

  // The volume's edges; words where its axes end.
  makeFrame(side) {
    const { min, max } = this.box, middle = this.box.getCenter(new THREE.Vector3()), word = this.radius / (this.boxes()[0][2] < STACKED_BELOW / 1.5 ? 8 : 11);
    const at = [[middle.x, min.y - 1.2 * word, min.z - 0.8 * word], [min.x - 2.4 * word, middle.y, min.z - 0.8 * word],
      [min.x - 1.8 * word, max.y + 1.8 * word, middle.z]];
    const words = AXES.map((name, axis) => {
      const sprite = wordSprite(name + " " + numberText(max.getComponent(axis) - min.getComponent(axis), 3) + " mm", word, this.colours.ink);
      sprite.position.set(...at[axis]);
      return sprite;
    });
    this.put(side, "frame", new THREE.Box3Helper(this.box, this.colours.quiet), ...words);
  }

  makeSurface(side) {
    if (side.parts.surface && side.ink === this.colours.ink)
      return;
    side.ink = this.colours.ink;
    const { about } = side.volume, sheets = about.surface === undefined ? null : this.viewer.surfaces[about.surface];
    const across = side.volume.edges(1), made = [];
    const add = (geometry, colour, flatShading, faint) => {
      for (const [plane, opacity] of [[this.farther, faint ? 0.3 : 1], [this.nearer, faint ? 0.1 : 0.15]])
        made.push(new THREE.Mesh(geometry, new THREE.MeshPhongMaterial({ color: colour, flatShading, side: THREE.DoubleSide, shininess: 12,
          clippingPlanes: [plane], transparent: opacity < 1, opacity, depthWrite: opacity === 1, polygonOffset: true, polygonOffsetFactor: faint ? 2 : 1, polygonOffsetUnits: faint ? 4 : 1 })));
    };
    if (sheets) {
      add(sheetSolid(sheets.nominal, across), 0xb9bec6, true, false);
      if (sheets.smooth)
        add(sheetSolid(sheets.smooth, across), this.colours.s0, false, true);
    } else {
      side.boundary = side.boundary || boundarySolid(side.volume, about.loop && about.loop.stiffness);
      add(side.boundary.clone(), 0xb9bec6, false, false);
    }
    this.put(side, "surface", ...made);
  }

  makeSlice(side) {
    const { viewer } = this, { axis, point, quantity, arrows } = viewer.state, one = side.volume, plane = slicePlane(axis);
    const at = one.position(axis, one.nearest(axis, point[axis])), [u, v] = plane.map((a) => one.edges(a));
    const corner = (i, k) => { const place = [0, 0, 0]; place[axis] = at; place[plane[0]] = u[i]; place[plane[1]] = v[k]; return place.map((value) => MM * value); };
    const corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
    const geometry = geometryOf([0, 1, 2, 0, 2, 3], { position: corners.flatMap(([i, k]) => corner(i, k)), uv: corners.flat() });
    const map = new THREE.CanvasTexture(viewer.panes[side.name].sheet);
    map.magFilter = map.minFilter = THREE.NearestFilter;
    const sheet = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ map, side: THREE.DoubleSide, alphaTest: 0.5 }));
    const rim = new THREE.LineLoop(new THREE.BufferGeometry().setFromPoints(corners.map(([i, k]) => new THREE.Vector3(...corner(i, k)))),
      new THREE.LineBasicMaterial({ color: this.colours.focus }));
    side.at = MM * at;
    this.put(side, "slice", sheet, rim, ...(arrows ? [this.arrowsOf(side, plane, at, quantity === "direction")] : []));
  }

  // Forces on a lattice in the slice.
  arrowsOf(side, plane, at, equal) {
    const one = side.volume, largest = Math.max(...this.sides.map((each) => each.volume.largest)) || 1;
    const spans = plane.map((a) => one.edges(a)[1] - one.edges(a)[0]), pitch = Math.max(...spans) / ARROWS_ACROSS, matrices = [];
    const counts = spans.map((span) => Math.max(1, Math.round(span / pitch)));
    for (let i = 0; i < counts[0]; ++i)
      for (let k = 0; k < counts[1]; ++k) {
        const index = [0, 0, 0];
        index[this.viewer.state.axis] = one.nearest(this.viewer.state.axis, at);
        plane.forEach((a, c) => { index[a] = one.nearest(a, one.edges(a)[0] + ([i, k][c] + 0.5) / counts[c] * spans[c]); });
        const force = one.sample(index), size = length(force);
        if (size > 0 && Number.isFinite(size))
          matrices.push(arrowMatrix(index.map((n, a) => MM * one.position(a, n)), force.map((f) => f / size * MM * pitch * (equal ? 0.8 : 1.4 * size / largest)), MM * pitch / 7));
      }
    const mesh = new THREE.InstancedMesh(arrowSolid(1), new THREE.MeshLambertMaterial({ color: LIGHT.ink }), Math.max(matrices.length, 1));
    mesh.count = matrices.length;
    mesh.frustumCulled = false;
    matrices.forEach((matrix, i) => mesh.setMatrixAt(i, matrix));
    return mesh;
  }

  // Every path as a line, the chosen one thick, coloured by the size of its force or by how fast its direction turns.
  drawPaths() {
    const walking = this.sides.filter((side) => side.paths), chosen = Number(byId("path").value), turns = byId("path-colour").value === "turn";
    const value = turns ? turnAt : (walk, i) => length(vectorAt(walk.force, i)) || 0;
    const values = walking.flatMap((side) => d3.range(side.paths.steps * side.paths.count).map((i) => value(side.paths, i))).sort(d3.ascending);
    const scale = turns ? new ColourScale(this.viewer.tables.second, 0, d3.quantile(values, 0.99) || 1, "turn of the force along the paths / (deg/mm); one place in 100 has more")
      : new ColourScale(this.viewer.tables.sequential, 0, d3.max(values) || 1, "size of the force along the paths / N");
    for (const side of walking) {
      const { steps, count, position } = side.paths, places = [], colours = [], index = [];
      for (let i = 0; i < steps * count; ++i) {
        const there = Number.isFinite(position[0][i]);
        places.push(...position.map((values) => there ? MM * values[i] : 0));
        colours.push(...(scale.rgb(value(side.paths, i)).map((value) => value / 255)));
        if (there && i % steps && Number.isFinite(position[0][i - 1]))
          index.push(i - 1, i);
      }
      const [all, own] = [index, index.filter((i) => Math.floor(i / steps) === chosen)].map((some) => geometryOf(some, { position: places, color: colours }));
      this.put(side, "paths", new THREE.LineSegments(all, new THREE.LineBasicMaterial({ vertexColors: THREE.VertexColors })),
        new THREE.Points(own, new THREE.PointsMaterial({ size: 5, sizeAttenuation: false, vertexColors: THREE.VertexColors })));
    }
    if (walking.length)
      scale.draw(byId("path-scale"));
    this.drawProbe();
  }

  // The probe on its path, its proxy, and the force.
  drawProbe() {
    const step = Number(byId("path-time").value), texts = [];
    for (const side of this.sides) {
      const walk = side.paths, i = walk ? Number(byId("path").value) * walk.steps + step : 0;
      const place = (name) => vectorAt(walk[name], i).map((value) => MM * value);
      if (!walk || step >= walk.steps || !Number.isFinite(walk.position[0][i])) {
        this.put(side, "probe");
        continue;
      }
      const force = vectorAt(walk.force, i), ball = (at, colour) => {
        const mesh = new THREE.Mesh(new THREE.SphereBufferGeometry(this.radius / 60, 16, 12), new THREE.MeshLambertMaterial({ color: colour }));
        mesh.position.set(...at);
        return mesh;
      };
      this.put(side, "probe", ball(place("position"), this.colours.s1), ...(walk.proxy ? [ball(place("proxy"), this.colours.s0)] : []),
        ...this.forceArrow(side, place("position"), force, this.colours.s1));
      texts.push((walk.rate && !texts.length ? "t = " + numberText(step / walk.rate, 3) + " s, " : "") + side.name.toUpperCase() + " " + numberText(length(force), 3) + " N");
    }
    byId("path-text").value = texts.join(", ");
    this.render();
  }

  forceArrow(side, from, force, colour) {
    const size = length(force), largest = Math.max(...this.sides.map((each) => each.volume.largest)) || 1;
    if (!(size > 0) || !Number.isFinite(size))
      return [];
    const mesh = new THREE.Mesh(arrowSolid(1), new THREE.MeshLambertMaterial({ color: colour, depthTest: false }));
    mesh.applyMatrix(arrowMatrix(from, force.map((f) => f / size * this.radius * Math.max(0.1, 0.5 * Math.min(size / largest, 1))), this.radius / 45));
    mesh.renderOrder = 1;
    return [mesh];
  }

  // As the hand went, or in six seconds where its times are not known.
  play() {
    const slider = byId("path-time"), last = Number(slider.max), walk = this.sides.find((side) => side.paths).paths;
    const seconds = walk.rate ? last / walk.rate : 6, began = performance.now(), from = Number(slider.value) >= last ? 0 : Number(slider.value);
    const go = (now) => {
      slider.value = Math.min(from + Math.max(now - began, 0) / 1e3 / seconds * last, last);
      this.drawProbe();
      this.playing = Number(slider.value) < last ? requestAnimationFrame(go) : this.stop();
    };
    this.playing = requestAnimationFrame(go);
    byId("path-play").textContent = "❚❚ pause";
  }

  stop() {
    cancelAnimationFrame(this.playing);
    byId("path-play").textContent = "▶ play";
    return this.playing = 0;
  }

  // The cursor moved: what is read there.
  mark() {
    const { point, axis } = this.viewer.state, texts = this.shown().map((one, i) => {
      const force = one.force(point);
      return "AB"[i] + ": " + (!force ? "no values here" : length(force) === 0 ? "no force"
        : numberText(length(force), 3) + " N, " + directionText(force, axis));
    });
    say("space-read", "At " + AXES.map((name, a) => name + " " + numberText(MM * point[a], 3)).join(", ") + " mm — " + texts.join("; "));
    this.render();
  }

  makeCursor(side) {
    const at = this.viewer.state.point.map((value) => MM * value), force = side.volume.force(this.viewer.state.point);
    const ball = new THREE.Mesh(new THREE.SphereBufferGeometry(this.radius / 90, 12, 8), new THREE.MeshBasicMaterial({ color: this.colours.focus, depthTest: false }));
    ball.position.set(...at);
    ball.renderOrder = 1;
    this.put(side, "cursor", ball, ...(force ? this.forceArrow(side, at, force, this.colours.focus) : []));
  }

  render() {
    if (!this.sides)
      return;
    if (printing)
      this.renderNow();
    else
      this.waiting = this.waiting || requestAnimationFrame(() => this.renderNow());
  }

  // Left and right, or one above the other on a narrow page: [left, top, width, height] of each of n, px.
  boxes(n = this.sides.length) {
    const width = byId("space-box").clientWidth, stacked = width < STACKED_BELOW;
    return d3.range(n).map((i) => stacked ? [0, i * SPACE_STACKED, width, SPACE_STACKED] : [i * width / n, 0, width / n, SPACE_HEIGHT]);
  }

  // What is below does not move when something is drawn.
  makeRoom(n) {
    byId("space-box").style.height = d3.max(this.boxes(n), ([, top, , h]) => top + h) + "px";
  }

  aspect() {
    const [, , w, h] = this.boxes()[0];
    return w / h;
  }

  renderNow() {
    this.waiting = 0;
    if (this.stale)
      this.makeAll();
    if (Math.abs(this.aspect() / this.camera.aspect - 1) > 0.05) // the window has another shape
      this.lookFromHome();
    this.makeRoom(this.sides.length);
    const boxes = this.boxes(), { clientWidth: width, clientHeight: height } = byId("space-box"), now = this.renderer.getSize(new THREE.Vector2());
    if (now.x !== width || now.y !== height)
      this.renderer.setSize(width, height);
    this.renderer.setClearColor(this.colours.paper);
    boxes.forEach(([left, top, w, h], i) => {
      const side = this.sides[i], { axis } = this.viewer.state, { position } = this.camera;
      this.makeCursor(side);
      const label = byId("space-title-" + side.name).style;
      Object.assign(label, { left: left + "px", top: top + "px", maxWidth: w + "px" });
      const from = Math.sign(position.getComponent(axis) - side.at) || 1;
      this.farther.normal.set(0, 0, 0).setComponent(axis, -from);
      this.farther.constant = from * side.at;
      this.nearer.copy(this.farther).negate();
      side.sun.position.copy(position).add(new THREE.Vector3(0, 0, this.radius));
      side.sun.target.position.copy(this.orbit.target);
      for (const set of ["setViewport", "setScissor"])
        this.renderer[set](left, height - top - h, w, h);
      this.renderer.render(side.scene, this.camera);
    });
  }

  // The place of a slice that is pointed at becomes the cursor's.
  pick(event) {
    const frame = this.canvas.getBoundingClientRect(), x = event.clientX - frame.left, y = event.clientY - frame.top;
    const boxes = this.sides ? this.boxes() : [], i = boxes.findIndex(([left, top, w, h]) => x >= left && x < left + w && y >= top && y < top + h);
    if (i < 0)
      return;
    const [left, top, w, h] = boxes[i], side = this.sides[i], { axis, point } = this.viewer.state, plane = slicePlane(axis);
    this.ray.setFromCamera({ x: 2 * (x - left) / w - 1, y: 1 - 2 * (y - top) / h }, this.camera);
    const normal = new THREE.Vector3().setComponent(axis, 1), hit = this.ray.ray.intersectPlane(new THREE.Plane(normal, -side.at), new THREE.Vector3());
    const place = hit && plane.map((a) => hit.getComponent(a) / MM);
    if (!place || !plane.every((a, c) => place[c] >= side.volume.edges(a)[0] && place[c] <= side.volume.edges(a)[1]))
      return;
    plane.forEach((a, c) => { point[a] = place[c]; });
    this.viewer.mark(false);
  }

  // The slice's samples as CSV.
  sliceText() {
    const { viewer } = this, { axis, point } = viewer.state, lines = ["case,x_m,y_m,z_m,fx_N,fy_N,fz_N"];
    for (const { volume: one } of this.sides)
      one.eachInSlice(viewer.plane, one.nearest(axis, point[axis]), (at) => {
        lines.push([one.about.name, ...at.map((n, a) => one.position(a, n).toPrecision(6)), ...one.sample(at).map((f) => f.toPrecision(4))].join(","));
      });
    return lines.join("\n") + "\n";
  }
}

const vectorAt = (vectors, i) => vectors.map((values) => values[i]);

// deg/mm: between a sample of a path and the one before; 0 out of contact, and where the probe hardly moves.
function turnAt(walk, i) {
  const moved = i % walk.steps ? MM * length(less(vectorAt(walk.position, i), vectorAt(walk.position, i - 1))) : 0;
  return moved > 1e-3 ? angleBetween(vectorAt(walk.force, i - 1), vectorAt(walk.force, i)) / moved || 0 : 0;
}

// "12° from +z towards +x, 3° out of the slice"
function directionText(force, axis) {
  const plane = slicePlane(axis), turn = direction(force, plane), [right, up] = plane.map((a) => AXES[a]);
  const out = Math.asin(force[axis] / length(force)) * DEGREES;
  return (turn === null ? "" : numberText(Math.abs(turn), 3) + "° from +" + up + " towards " + (turn < 0 ? "−" : "+") + right) +
    (Math.abs(out) < 0.05 ? "" : (turn === null ? "" : ", ") + numberText(out, 2) + "° out of the slice");
}
