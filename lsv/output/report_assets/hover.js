// SPDX-License-Identifier: BSD-3-Clause
// One point of the run under the mouse, shown by every chart and told in the read-out.
const hoverListeners = new Map();

function onHover(chart, show) { hoverListeners.set(chart, show); }

function hover(index) {
  for (const show of hoverListeners.values()) show(index);
  tellPoint(index);
}

function tellPoint(index) {
  const line = byId("readout");
  line.textContent = "";
  if (index === null) {
    line.textContent = "Point at a chart to read its values; drag across one to zoom in.";
    return;
  }
  const say = (name, value) => {
    line.appendChild(document.createTextNode(name + "\u00a0"));
    add(line, "b", value);
    line.appendChild(document.createTextNode("   "));
  };
  const last = series.last_frame[index], first = series.frame[index];
  say("t", digits(series.t_s[index], 6) + "\u00a0s");
  say("frame", first === last ? count(first) : count(first) + "\u2013" + count(last));
  say("vx", withSigma(series.vx_m_s[index], series.sigma_vx_m_s[index], "m/s"));
  say("vy", withSigma(series.vy_m_s[index], series.sigma_vy_m_s[index], "m/s"));
  say("Q", digits(firstKnown(series.q[index], series.refused_q[index]), 3));
  say("ZNCC", digits(firstKnown(series.zncc[index], series.refused_zncc[index]), 3));
  say("x", withUnit(series.x_m[index], "m"));
  say("y", withUnit(series.y_m[index], "m"));
  const refused = refusals.get(index);
  if (refused) add(line, "span", refusedText(refused), "bad");
}

function firstKnown(value, other) { return isKnown(value) ? value : other; }

function refusedText(byReason) {
  return Object.entries(byReason)
    .map(([status, n]) => status + (series.frames_per_point > 1 ? " \u00d7 " + n : ""))
    .join(", ");
}

// Point index -> {reason: how many}.
const refusals = new Map(series.refused);
