// Studies: what each found, its figures, and its tables on demand.

const MOST_ON_PAPER = 200; // rows of a table

function tableElement(table) {
  const details = document.createElement("details"), rows = table.rows.length;
  details.append(Object.assign(document.createElement("summary"), { textContent: (table.title || table.name) + ` (${rows} row${rows === 1 ? "" : "s"})` }));
  const fill = () => {
    if (details.querySelector("table"))
      return;
    const box = d3.select(details).append("div").attr("class", "wide").attr("tabindex", 0).attr("role", "region").attr("aria-label", table.title);
    const whole = box.append("table"), number = (column) => column.unit !== "";
    whole.append("thead").append("tr").selectAll("th").data(table.columns).enter().append("th").attr("scope", "col").attr("title", (c) => c.meaning)
      .classed("n", number).html("").each(function (column) {
        this.append(column.name);
        if (column.unit && column.unit !== "1")
          this.append(Object.assign(document.createElement("small"), { textContent: column.unit }));
      });
    whole.append("tbody").selectAll("tr").data(table.rows).enter().append("tr").selectAll("td").data((row) => row).enter().append("td")
      .classed("n", (_, i) => number(table.columns[i])).text((cell) => cell === null ? "–" : typeof cell !== "number" ? cell : Number.isInteger(cell) && Math.abs(cell) < 1e15 ? String(cell).replace("-", "−") : numberText(cell, 5));
  };
  details.addEventListener("toggle", () => details.open && fill());
  addEventListener("beforeprint", () => rows <= MOST_ON_PAPER && fill());
  return details;
}

// Tables come by columns, those of few different cells as these and whereabouts they are.
function unpacked(study) {
  study.tables.forEach((table) => {
    table.rows = d3.transpose(table.cells.map((cells) => cells.of ? cells.at.map((i) => cells.of[i]) : cells));
  });
  return study;
}

function startStudies() {
  document.querySelectorAll("script.study").forEach((script) => {
    const study = unpacked(JSON.parse(script.textContent)), element = (name, ...path) => document.getElementById(script.id + name);
    const linked = study.figures.flatMap((figure) => figure.linked);
    study.figures.filter((figure) => !linked.includes(figure.name))
      .forEach((figure, i) => linkFigures(element(i === 0 ? "-hero" : "-figures").appendChild(document.createElement("figure")), study, figure));
    const glance = element("-glance"), shown = glance && (study.figures.find((one) => one.name === glance.dataset.figure) || study.figures[0]);
    if (shown)
      drawFigure(glance, study, { ...shown, height: 300, picks: [] }, true);
    study.tables.forEach((table) => element("-tables").append(tableElement(table)));
  });
  document.documentElement.dataset.figures = "ready";
}

startStudies();
