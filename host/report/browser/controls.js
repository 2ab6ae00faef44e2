// How the viewer is moved: by pointer, by keys, by its fields.

class Controls extends Viewer {
  moveSlice(steps) {
    const { axis, point } = this.state, index = this.a.nearest(axis, point[axis]) + steps;
    point[axis] = this.a.position(axis, Math.min(Math.max(index, 0), this.a.size[axis] - 1));
    this.draw();
  }

  moveCursor(axis, steps) {
    const { point } = this.state, [low, high] = this.a.edges(axis);
    const step = this.a.size[axis] > 1 ? this.a.pitch[axis] : this.a.about.spacing_m[axis];
    point[axis] = Math.min(Math.max(point[axis] + steps * step, low), high);
    this.mark(false);
  }

  setStroke(end, place) {
    this.stroke[end] = place.map((value, c) => {
      const [low, high] = this.a.edges(this.plane[c]);
      return Math.min(Math.max(value, low), high);
    });
    this.mark(true);
  }

  onKey(event) {
    const steps = event.shiftKey ? 10 : 1, [u, v] = this.plane, { point } = this.state;
    const moves = { ArrowLeft: () => this.moveCursor(u, -steps), ArrowRight: () => this.moveCursor(u, steps),
      ArrowDown: () => this.moveCursor(v, -steps), ArrowUp: () => this.moveCursor(v, steps),
      PageUp: () => this.moveSlice(steps), PageDown: () => this.moveSlice(-steps),
      1: () => this.setStroke(0, [point[u], point[v]]), 2: () => this.setStroke(1, [point[u], point[v]]) };
    if (moves[event.key] && !event.ctrlKey && !event.altKey && !event.metaKey) {
      moves[event.key]();
      event.preventDefault();
    }
  }

  onPointer(pane, event) {
    const box = pane.canvas.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top, place = pane.place(x, y);
    if (event.type === "pointerdown") {
      this.held = this.stroke.findIndex((end) => Math.hypot(pane.at(end)[0] - x, pane.at(end)[1] - y) < HANDLE);
      if (this.held >= 0)
        pane.canvas.setPointerCapture(event.pointerId);
    }
    if (event.type === "pointerup" || event.type === "pointercancel")
      this.held = -1;
    this.plane.forEach((axis, c) => { this.state.point[axis] = place[c]; });
    if (this.held >= 0)
      this.setStroke(this.held, place);
    else
      this.mark(false);
  }

  listen() {
    this.held = -1;
    byId("quantity").addEventListener("change", (event) => { this.state.quantity = event.target.value; this.draw(); });
    byId("arrows").addEventListener("change", (event) => { this.state.arrows = event.target.checked; this.draw(); });
    byId("slice").addEventListener("input", (event) => this.moveSlice(event.target.value - this.a.nearest(this.state.axis, this.state.point[this.state.axis])));
    byId("slice-back").addEventListener("click", () => this.moveSlice(-1));
    byId("slice-on").addEventListener("click", () => this.moveSlice(1));
    AXES.forEach((name, axis) => byId("axis-" + name).addEventListener("change", () => { this.state.axis = axis; this.settle(); this.draw(); }));
    for (const end of [0, 1])
      for (const c of [0, 1])
        byId("stroke-" + end + "-" + c).addEventListener("input", (event) => {
          const place = [...this.stroke[end]];
          place[c] = event.target.valueAsNumber / 1e3;
          if (Number.isFinite(place[c]))
            this.setStroke(end, place);
        });
    for (const pane of Object.values(this.panes)) {
      pane.canvas.addEventListener("keydown", (event) => this.onKey(event));
      for (const type of ["pointerdown", "pointermove", "pointerup", "pointercancel"])
        pane.canvas.addEventListener(type, (event) => this.onPointer(pane, event));
    }
    new IntersectionObserver((seen, watch) => {
      if (seen.some((one) => one.isIntersecting)) {
        watch.disconnect();
        this.space.start();
      }
    }, { rootMargin: "200px" }).observe(byId("space-box"));
    document.querySelectorAll("#viewer form").forEach((form) => form.addEventListener("submit", (event) => event.preventDefault()));
    window.addEventListener("resize", () => this.draw());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }
}
