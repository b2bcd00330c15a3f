// SPDX-License-Identifier: BSD-3-Clause
// Heading, key figures and tables.
function drawHeading() {
  byId("source").textContent = settings.source + " \u00b7 " + settings.frame_width_px + " \u00d7 " +
    settings.frame_height_px + " px, " + settings.bit_depth + " bit \u00b7 " + settings.time_base;
  if (summary.interrupted) {
    add(byId("notices"), "span", "The run was interrupted: frames after the last one are missing.",
      "notice");
  }
  if (summary.static_share > data.dirty_share) {
    add(byId("notices"), "span", percent(summary.static_share) +
      " of the image does not move with the ground: clean the optics, distances may be short.",
      "notice");
  }
  byId("made-by").textContent =
    "lsv " + settings.lsv_version + ", laser speckle velocimetry. Sigmas hold the random error " +
    "of the accepted shifts and, where the calibration tells it, of the scale. " +
    "This file needs no network.";
}

function drawTile(name, value, more) {
  const tile = add(byId("tiles"), "div", undefined, "tile");
  add(tile, "div", name, "name");
  const [number, ...unit] = value.split("\u00a0");
  const line = add(tile, "div", number, "value");
  if (unit.length) add(line, "small", "\u00a0" + unit.join(" "));
  add(tile, "div", more, "more");
}

function drawTiles() {
  const shifts = summary.shifts_ok + summary.shifts_rejected;
  drawTile("Path length", withUnit(summary.path_length_m, "m"),
    "in " + withUnit(summary.duration_s, "s"));
  drawTile("End position x", withUnit(summary.end_x_m, "m"),
    "\u03c3 " + withUnit(summary.end_sigma_x_m, "m", 2));
  drawTile("End position y", withUnit(summary.end_y_m, "m"),
    "\u03c3 " + withUnit(summary.end_sigma_y_m, "m", 2));
  drawTile("Mean speed", withUnit(summary.mean_speed_m_s, "m/s"),
    "highest " + withUnit(summary.max_speed_m_s, "m/s"));
  drawTile("Accepted shifts", shifts ? percent(summary.shifts_ok / shifts) : unknown,
    count(summary.shifts_ok) + " of " + count(shifts));
  drawTile("Position held", withUnit(summary.held_time_s, "s", 3),
    plural(summary.shifts_rejected, "rejected shift"));
}

function pairRow(table, name, value) {
  const row = add(table, "tr");
  add(row, "th", name).scope = "row";
  add(row, "td", value);
}

function drawSummary() {
  const table = add(byId("summary"), "tbody");
  pairRow(table, "Frames", count(summary.frames));
  pairRow(table, "Missing frames", count(summary.missing_frames));
  pairRow(table, "First stamp", data.start_s + "\u00a0s");
  pairRow(table, "Duration", withUnit(summary.duration_s, "s", 5));
  pairRow(table, "Shifts accepted", count(summary.shifts_ok));
  pairRow(table, "Shifts rejected", count(summary.shifts_rejected) + " (" +
    percent(summary.rejected_share) + ")");
  pairRow(table, "Position held for", withUnit(summary.held_time_s, "s"));
  pairRow(table, "Path length", withUnit(summary.path_length_m, "m", 5));
  pairRow(table, "End x (\u00b1 1\u03c3)",
    withSigma(summary.end_x_m, summary.end_sigma_x_m, "m"));
  pairRow(table, "End y (\u00b1 1\u03c3)",
    withSigma(summary.end_y_m, summary.end_sigma_y_m, "m"));
  pairRow(table, "Mean speed", withUnit(summary.mean_speed_m_s, "m/s"));
  pairRow(table, "Highest speed", withUnit(summary.max_speed_m_s, "m/s"));
  pairRow(table, "Mean ZNCC", digits(summary.mean_zncc));
  pairRow(table, "Median Q", digits(summary.median_q, 3));
  pairRow(table, "Static share of the image", percent(summary.static_share));
}

function drawReasons() {
  if (!data.reasons.length) {
    add(byId("reasons"), "p", "Every shift was accepted.", "note");
    return;
  }
  const table = add(byId("reasons"), "table", undefined, "list");
  const head = add(add(table, "thead"), "tr");
  for (const [name, className] of
    [["Reason"], ["Shifts", "number"], ["Share", "number"], ["What it means and what to try"]]) {
    add(head, "th", name, className).scope = "col";
  }
  const body = add(table, "tbody");
  for (const reason of data.reasons) {
    const row = add(body, "tr");
    add(add(row, "td"), "code", reason.status);
    add(row, "td", count(reason.count), "number");
    add(row, "td", percent(reason.share), "number");
    add(row, "td", reason.advice);
  }
}

function drawSettings() {
  byId("signs").textContent = "Signs: " + settings.sign_convention + ". Units: " +
    settings.units + ".";
  const table = add(byId("settings"), "tbody");
  for (const [name, value] of Object.entries(settings)) {
    if (name === "units" || name === "sign_convention") continue;
    pairRow(table, name, isKnown(value) && value !== "" ? String(value) : unknown);
  }
}
