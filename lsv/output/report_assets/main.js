// SPDX-License-Identifier: BSD-3-Clause
// Draws everything once, and the charts again when the width changes.
function drawCharts() {
  if (series.t_s.length) {
    drawTrajectory();
    drawTimeCharts();
  } else {
    byId("trajectory-note").textContent = "The run has no frames.";
  }
  drawPair();
}

function drawAll() {
  drawHeading();
  drawTiles();
  drawSummary();
  drawReasons();
  drawSettings();
  drawCharts();
  hover(null);
  byId("zoom-reset").addEventListener("click", () => zoomTo(fullDomain));
}

let drawnWidth = root.clientWidth;
window.addEventListener("resize", () => {
  if (root.clientWidth === drawnWidth) return;
  drawnWidth = root.clientWidth;
  drawCharts();
});

try {
  drawAll();
  root.dataset.lsvHeightPx = root.scrollHeight;
  root.dataset.lsvReady = "1";
} catch (error) {
  fail(error.stack || String(error));
}
