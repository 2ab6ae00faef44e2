// What a probe would feel along the stroke: a number of both cases against the way.

// lines: [{name, values (null: none), colour, dash}], all as long as ways (mm).
function drawProfile(canvas, ways, lines, label, wayLabel) {
  const { context, width, height } = prepare(canvas, 270), colours = palette();
  const plot = { x: 62, y: 26, width: width - 74, height: height - 66 };
  const values = lines.flatMap((line) => line.values).filter((value) => value !== null && Number.isFinite(value));
  let low = Math.min(0, ...values), high = Math.max(0, ...values);
  if (!(high > low))
    [low, high] = [low - 1, high + 1];
  const pad = 0.06 * (high - low);
  if (low < 0)
    low -= pad;
  if (high > 0)
    high += pad;
  const end = Math.max(ways[ways.length - 1], 1e-9);
  const px = (way) => plot.x + way / end * plot.width, py = (value) => plot.y + plot.height * (high - value) / (high - low);

  context.textAlign = "right";
  for (const tick of roundTicks(low, high, 5)) {
    context.fillStyle = colours.grid;
    context.fillRect(plot.x, py(tick.value) - 0.5, plot.width, 1);
    context.fillStyle = colours.ink;
    context.fillText(Math.abs(high - low) < 1e-3 ? numberText(tick.value, 2) : tick.text, plot.x - 6, py(tick.value) + 4);
  }
  context.textAlign = "center";
  for (const tick of roundTicks(0, end, Math.max(plot.width / 70, 2))) {
    context.fillStyle = colours.ink;
    context.fillRect(px(tick.value) - 0.5, plot.y + plot.height, 1, 4);
    context.fillText(tick.text, px(tick.value), plot.y + plot.height + 16);
  }
  context.fillText(wayLabel, plot.x + plot.width / 2, height - 6);
  context.save();
  context.translate(12, plot.y + plot.height / 2);
  context.rotate(-Math.PI / 2);
  context.fillText(label, 0, 0);
  context.restore();
  context.strokeStyle = colours.ink;
  context.lineWidth = 1;
  context.strokeRect(plot.x - 0.5, plot.y - 0.5, plot.width + 1, plot.height + 1);

  let x = plot.x;
  for (const line of lines) {
    context.strokeStyle = line.colour;
    context.lineWidth = 2;
    context.setLineDash(line.dash);
    context.beginPath();
    let drawn = false;
    line.values.forEach((value, i) => {
      if (value !== null && Number.isFinite(value))
        context[drawn ? "lineTo" : "moveTo"](px(ways[i]), py(value));
      drawn = value !== null && Number.isFinite(value);
    });
    context.moveTo(x, 12);
    context.lineTo(x + 28, 12);
    context.stroke();
    context.setLineDash([]);
    context.textAlign = "left";
    context.fillStyle = colours.ink;
    context.fillText(line.name, x + 34, 16);
    x += 34 + context.measureText(line.name).width + 22;
  }
  canvas.setAttribute("aria-label", label + " along the stroke");
}
