// One slice of a volume, or of the difference of two, as a picture.

const MARGIN = { left: 46, right: 10, top: 6, bottom: 36 };
const HIGHEST = 460, ARROW_PITCH = 24; // px

class Pane {
  constructor(canvas) {
    this.canvas = canvas;
  }

  // `view`: the grid's volume, the slice's plane and index, cell(at): the number of a sample's colour or null, and
  // force(at): its arrow or null.
  show(view) {
    this.view = view;
    const { volume, plane } = view, [u, v] = plane.map((a) => volume.edges(a));
    const wide = Math.max((this.canvas.clientWidth || this.canvas.parentElement.clientWidth) - MARGIN.left - MARGIN.right, 60);
    const scale = Math.min(wide / (u[1] - u[0]), HIGHEST / (v[1] - v[0]));
    const plot = { x: MARGIN.left, y: MARGIN.top, width: Math.max(scale * (u[1] - u[0]), 30), height: Math.max(scale * (v[1] - v[0]), 40) };
    Object.assign(this, { plot, u, v });
    const { context } = prepare(this.canvas, plot.height + MARGIN.top + MARGIN.bottom);
    this.drawCells(context);
    this.drawAxes(context);
    if (view.arrows)
      this.drawArrows(context);
    this.below = document.createElement("canvas");
    Object.assign(this.below, { width: this.canvas.width, height: this.canvas.height });
    this.below.getContext("2d").drawImage(this.canvas, 0, 0);
    this.mark();
  }

  // Stroke and cursor anew over what is drawn already.
  mark() {
    const context = this.canvas.getContext("2d");
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.below, 0, 0);
    context.restore();
    this.drawStroke(context);
    this.drawCursor(context);
  }

  // px of a place in the plane (m), and back.
  at(place) {
    return [this.plot.x + (place[0] - this.u[0]) / (this.u[1] - this.u[0]) * this.plot.width,
      this.plot.y + this.plot.height - (place[1] - this.v[0]) / (this.v[1] - this.v[0]) * this.plot.height];
  }

  place(x, y) {
    const s = Math.min(Math.max((x - this.plot.x) / this.plot.width, 0), 1);
    const t = Math.min(Math.max((this.plot.y + this.plot.height - y) / this.plot.height, 0), 1);
    return [this.u[0] + s * (this.u[1] - this.u[0]), this.v[0] + t * (this.v[1] - this.v[0])];
  }

  drawCells(context) {
    const { volume, plane, index, cell, scale } = this.view;
    const columns = volume.size[plane[0]], rows = volume.size[plane[1]];
    const cells = new ImageData(columns, rows);
    this.blank = true;
    volume.eachInSlice(plane, index, (at, row, column) => {
      const rgb = scale.rgb(cell(at));
      if (rgb)
        cells.data.set([...rgb, 255], 4 * ((rows - 1 - row) * columns + column));
      this.blank = this.blank && !rgb;
    });
    const sheet = this.sheet = document.createElement("canvas"); // a pixel a sample; drawn in space, too
    Object.assign(sheet, { width: columns, height: rows });
    sheet.getContext("2d").putImageData(cells, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(sheet, this.plot.x, this.plot.y, this.plot.width, this.plot.height);
  }

  drawAxes(context) {
    const { plot, u, v } = this, colours = palette(), [right, up] = this.view.plane.map((a) => AXES[a]);
    context.strokeStyle = context.fillStyle = colours.ink;
    context.lineWidth = 1;
    context.strokeRect(plot.x - 0.5, plot.y - 0.5, plot.width + 1, plot.height + 1);
    context.textAlign = "center";
    for (const tick of roundTicks(1e3 * u[0], 1e3 * u[1], Math.max(plot.width / 60, 2))) {
      const x = this.at([tick.value / 1e3, v[0]])[0];
      context.fillRect(x - 0.5, plot.y + plot.height, 1, 4);
      context.fillText(tick.text, x, plot.y + plot.height + 15);
    }
    context.fillText(right + " / mm", plot.x + plot.width / 2, plot.y + plot.height + 31);
    context.textAlign = "right";
    for (const tick of roundTicks(1e3 * v[0], 1e3 * v[1], Math.max(plot.height / 40, 1))) {
      const y = this.at([u[0], tick.value / 1e3])[1];
      context.fillRect(plot.x - 4, y - 0.5, 4, 1);
      context.fillText(tick.text, plot.x - 6, y + 4);
    }
    context.save();
    context.translate(11, plot.y + plot.height / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText(up + " / mm", 0, 0);
    context.restore();
  }

  drawArrows(context) {
    const { volume, plane, index, force, arrowScale, equalArrows } = this.view, { plot } = this, colours = palette();
    const across = Math.max(Math.floor(plot.width / ARROW_PITCH), 1), upwards = Math.max(Math.floor(plot.height / ARROW_PITCH), 1);
    const path = new Path2D();
    for (let i = 0; i < across; ++i)
      for (let k = 0; k < upwards; ++k) {
        const middle = this.place(plot.x + (i + 0.5) * plot.width / across, plot.y + (k + 0.5) * plot.height / upwards);
        const at = [index, index, index];
        plane.forEach((a, c) => { at[a] = volume.nearest(a, middle[c]); });
        const f = force(at), size = f ? Math.hypot(f[plane[0]], f[plane[1]]) : 0;
        if (size > 0 && Number.isFinite(size) && arrowScale > 0) {
          const reach = 0.95 * ARROW_PITCH * (equalArrows ? 0.8 : Math.min(size / arrowScale, 1)) / size;
          addArrow(path, this.at(plane.map((a) => volume.position(a, at[a]))), f[plane[0]] * reach, -f[plane[1]] * reach);
        }
      }
    strokeTwice(context, path, [colours.paper, 3], [colours.ink, 1.1]);
  }

  drawStroke(context) {
    const colours = palette(), line = this.view.stroke().map((place) => this.at(place)), ends = [line[0], line[line.length - 1]];
    strokeTwice(context, new Path2D("M" + line.join("L")), [colours.paper, 5], [colours.focus, 2]);
    context.textAlign = "center";
    ends.forEach(([x, y], i) => {
      context.beginPath();
      context.arc(x, y, 8, 0, 2 * Math.PI);
      context.fillStyle = colours.paper;
      context.fill();
      context.strokeStyle = colours.focus;
      context.stroke();
      context.fillStyle = colours.ink;
      context.fillText(String(i + 1), x, y + 4);
    });
  }

  drawCursor(context) {
    const [x, y] = this.at(this.view.cursor()), { plot } = this, colours = palette();
    const path = new Path2D(`M${x},${Math.max(y - 14, plot.y)}V${Math.min(y + 14, plot.y + plot.height)}` +
      `M${Math.max(x - 14, plot.x)},${y}H${Math.min(x + 14, plot.x + plot.width)}`);
    strokeTwice(context, path, [colours.paper, 4], [colours.ink, 1.5]);
  }
}

// A halo, and the line over it: [colour, width] each.
function strokeTwice(context, path, ...strokes) {
  for (const [colour, width] of strokes) {
    Object.assign(context, { strokeStyle: colour, lineWidth: width });
    context.stroke(path);
  }
}

function addArrow(path, [x, y], dx, dy) {
  const size = Math.hypot(dx, dy), head = Math.min(4, size / 2);
  const [ex, ey] = [x + dx / 2, y + dy / 2], [ux, uy] = [dx / size * head, dy / size * head];
  path.moveTo(x - dx / 2, y - dy / 2);
  path.lineTo(ex, ey);
  path.moveTo(ex - ux - uy * 0.6, ey - uy + ux * 0.6);
  path.lineTo(ex, ey);
  path.lineTo(ex - ux + uy * 0.6, ey - uy - ux * 0.6);
}
