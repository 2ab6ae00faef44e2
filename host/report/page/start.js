// On paper everything is unfolded and light.
function printWhole(viewer) {
  let opened = [];
  addEventListener("beforeprint", () => {
    printing = true;
    opened = [...document.querySelectorAll("details:not([open])")];
    opened.forEach((one) => { one.open = true; });
    if (viewer && viewer.a)
      viewer.draw();
  });
  addEventListener("afterprint", () => {
    printing = false;
    opened.forEach((one) => { one.open = false; });
    if (viewer && viewer.a)
      viewer.draw();
  });
}

async function startViewer() {
  const about = byId("volumes");
  if (!about) {
    printWhole(null);
    return;
  }
  const status = byId("viewer-status");
  if (!canUnpack()) {
    status.textContent = "This browser cannot unpack the volumes: it lacks DecompressionStream, which browsers have since 2023. " +
      "The EXR files beside this page hold them.";
    printWhole(null);
    return;
  }
  const viewer = new Controls(JSON.parse(about.textContent));
  printWhole(viewer);
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
