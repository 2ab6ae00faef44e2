// The viewer is started. On paper everything is unfolded and light.
let viewer = null;

function printWhole(begins) {
  printing = begins;
  for (const one of document.querySelectorAll(begins ? "details:not([open])" : "details[data-folded]")) {
    one.open = begins;
    one.toggleAttribute("data-folded", begins);
  }
  if (viewer && viewer.a)
    viewer.draw();
}

async function startViewer() {
  const about = byId("volumes"), status = byId("viewer-status");
  addEventListener("beforeprint", () => printWhole(true));
  addEventListener("afterprint", () => printWhole(false));
  if (!about)
    return;
  if (typeof DecompressionStream === "undefined") {
    status.textContent = "This browser cannot unpack the volumes: it lacks DecompressionStream, which browsers have since 2023. " +
      "The EXR files next to this page hold them.";
    return;
  }
  viewer = new Controls(JSON.parse(about.textContent));
  try {
    status.textContent = "Unpacking …";
    await viewer.start();
    status.textContent = "";
    document.documentElement.dataset.viewer = "ready";
  } catch (error) {
    status.textContent = "The viewer cannot start: " + error.message;
  }
}

startViewer();
