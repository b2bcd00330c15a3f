// SPDX-License-Identifier: BSD-3-Clause
// Velocity, Q, ZNCC and refusals above one time axis; dragging zooms all of them.
const timeMargin = {top: 6, right: 14, bottom: 22, left: 58};
const wholeRun = extent(series.t_s) || [0, 1];
let timeDomain = wholeRun[0] < wholeRun[1] ? wholeRun : [wholeRun[0], wholeRun[0] + 1];
const fullDomain = timeDomain;

function zoomTo(domain) {
  timeDomain = domain;
  byId("zoom-reset").hidden = domain === fullDomain;
  drawTimeCharts();
}

// Indices of the points in view and one neighbour on either side.
function pointsInView() {
  const first = Math.max(d3.bisectLeft(series.t_s, timeDomain[0]) - 1, 0);
  return d3.range(first, Math.min(d3.bisectRight(series.t_s, timeDomain[1]) + 1,
    series.t_s.length));
}

// Frame, axes and scales of one chart; `yDomain` null when nothing is known.
function timeChart(id, height, yDomain, label, yUnit) {
  const width = widthOf(id), margin = timeMargin;
  const chart = {
    width: width - margin.left - margin.right,
    height: height - margin.top - margin.bottom,
    points: pointsInView(),
  };
  const t = scaleFor(timeDomain[1] - timeDomain[0] < 0.5 && timeDomain === fullDomain ?
    timeDomain[1] - timeDomain[0] : 1, "s");
  chart.x = d3.scale.linear().domain(timeDomain).range([0, chart.width]);
  chart.y = d3.scale.linear().domain(yDomain || [0, 1]).range([chart.height, 0]);
  const svg = newSvg(id, width, height, label);
  const clip = id + "-clip";
  svg.append("clipPath").attr("id", clip).append("rect")
    .attr({y: -1, width: chart.width, height: chart.height + 2});
  chart.frame = svg.append("g")
    .attr("transform", "translate(" + margin.left + "," + margin.top + ")");
  const axis = d3.scale.linear().range([0, chart.width])
    .domain(timeDomain.map(value => value * t.factor));
  chart.frame.append("g").attr({class: "axis", transform: "translate(0," + chart.height + ")"})
    .call(d3.svg.axis().scale(axis).ticks(Math.max(3, Math.floor(chart.width / 90)))
      .tickSize(-chart.height).tickPadding(7));
  svg.append("text").attr({x: 8, y: height - 6}).text("t (" + t.unit + ")");
  if (yUnit) {
    svg.append("text").attr("text-anchor", "middle").text(yUnit)
      .attr("transform", "translate(13," + (margin.top + chart.height / 2) + ") rotate(-90)");
  }
  chart.body = chart.frame.append("g").attr("clip-path", "url(#" + clip + ")");
  return chart;
}

function yAxis(chart, ticks) {
  chart.frame.insert("g", ":first-child").attr("class", "axis")
    .call(d3.svg.axis().scale(chart.y).orient("left").ticks(ticks).tickSize(-chart.width)
      .tickPadding(8));
}

function addLine(chart, values, colour) {
  const known = i => isKnown(values[i]);
  chart.body.append("path").datum(chart.points).attr("class", "path s-" + colour)
    .attr("d", d3.svg.line().x(i => chart.x(series.t_s[i])).y(i => chart.y(values[i]))
      .defined(known));
  // A point with unknown neighbours has no line to be seen by.
  const alone = chart.points.filter(i => known(i) && !known(i - 1) && !known(i + 1));
  addDots(chart, alone, values, "f-" + colour, 1.5);
}

function addDots(chart, points, values, className, radius) {
  const disc = "m-" + radius + ",0a" + radius + "," + radius + " 0 1,0 " + 2 * radius + ",0a" +
    radius + "," + radius + " 0 1,0 -" + 2 * radius + ",0";
  chart.body.append("path").attr("class", className).attr("d", points.map(i =>
    "M" + chart.x(series.t_s[i]) + "," + chart.y(values[i]) + disc).join(""));
}

function addBand(chart, low, high, className) {
  chart.body.append("path").datum(chart.points).attr("class", className)
    .attr("d", d3.svg.area().x(i => chart.x(series.t_s[i])).y0(i => chart.y(low(i)))
      .y1(i => chart.y(high(i))).defined(i => isKnown(low(i)) && isKnown(high(i))));
}

function closeChart(id, chart) {
  chart.frame.append("rect").attr({class: "frame", width: chart.width, height: chart.height});
  const cursor = chart.frame.append("line").attr({class: "cursor", y2: chart.height})
    .style("display", "none");
  onHover(id, i => {
    const at = i === null ? -1 : chart.x(series.t_s[i]);
    const seen = at >= 0 && at <= chart.width;
    cursor.style("display", seen ? null : "none").attr({x1: at, x2: at});
  });
  catchMouse(chart);
}

function nearestInTime(t) {
  const after = Math.min(d3.bisectLeft(series.t_s, t), series.t_s.length - 1);
  const before = Math.max(after - 1, 0);
  return t - series.t_s[before] < series.t_s[after] - t ? before : after;
}

function catchMouse(chart) {
  const selection = chart.frame.append("rect").attr({class: "selection", height: chart.height});
  const catcher = chart.frame.append("rect")
    .attr({class: "catcher", width: chart.width, height: chart.height})
    .on("mousemove", function () { hover(nearestInTime(chart.x.invert(d3.mouse(this)[0]))); })
    .on("mouseout", () => hover(null))
    .on("dblclick", () => zoomTo(fullDomain))
    .on("mousedown", function () {
      d3.event.preventDefault();
      const area = this;
      const at = () => Math.min(Math.max(d3.mouse(area)[0], 0), chart.width);
      const start = at();
      const ends = () => [Math.min(start, at()), Math.max(start, at())];
      d3.select(window).on("mousemove.zoom", () => {
        const [left, right] = ends();
        selection.attr({x: left, width: right - left});
      }).on("mouseup.zoom", () => {
        const [left, right] = ends();
        d3.select(window).on("mousemove.zoom", null).on("mouseup.zoom", null);
        selection.attr("width", 0);
        if (right - left > 5) zoomTo([chart.x.invert(left), chart.x.invert(right)]);
      });
    });
  return catcher;
}

function inView(values) {
  const points = pointsInView();
  return points.map(i => values[i]);
}

function drawVelocity() {
  const lowest = series.vx_min_m_s || series.vx_m_s, highest = series.vx_max_m_s || series.vx_m_s;
  const lowestY = series.vy_min_m_s || series.vy_m_s, highestY = series.vy_max_m_s || series.vy_m_s;
  const range = extent(inView(lowest), inView(highest), inView(lowestY), inView(highestY));
  const unit = scaleFor(range ? Math.max(-range[0], range[1]) : 1, "m/s");
  const domain = range && padded(range.map(v => v * unit.factor), 0.08);
  const chart = timeChart("velocity", 240, domain, "Velocity over time", "velocity (" + unit.unit +
    ")");
  yAxis(chart, 5);
  const scaled = values => values.map(v => isKnown(v) ? v * unit.factor : null);
  if (domain && domain[0] < 0 && domain[1] > 0) {
    chart.body.append("line").attr({class: "zero", x2: chart.width, y1: chart.y(0),
      y2: chart.y(0)});
  }
  for (const axis of ["y", "x"]) {
    const v = scaled(series["v" + axis + "_m_s"]);
    const sigma = scaled(series["sigma_v" + axis + "_m_s"]);
    if (series.frames_per_point > 1) {
      const low = scaled(series["v" + axis + "_min_m_s"]);
      const high = scaled(series["v" + axis + "_max_m_s"]);
      addBand(chart, i => low[i], i => high[i], "envelope f-" + axis);
    }
    const known = i => isKnown(v[i]) && isKnown(sigma[i]);
    addBand(chart, i => known(i) ? v[i] - 2 * sigma[i] : null,
      i => known(i) ? v[i] + 2 * sigma[i] : null, "band f-" + axis);
    addLine(chart, v, axis);
  }
  closeChart("velocity", chart);
  const items = [["line", "x", "vx"], ["line", "y", "vy"],
    ["band", "soft", "\u00b1 2\u03c3 of one frame pair"]];
  if (series.frames_per_point > 1) items.push(["band", "soft", "wider, fainter: lowest to highest"]);
  legend("velocity-legend", items);
}

// One quality measure against its gate, refused shifts as dots.
function drawQuality(id, legendId, name, gate, label, floor) {
  const values = series[name], refused = series["refused_" + name];
  const low = series[name + "_min"] || values, high = series[name + "_max"] || values;
  const range = extent(inView(low), inView(high), inView(refused), [gate, floor]);
  const chart = timeChart(id, 130, padded(range, 0.08), label + " over time", label);
  yAxis(chart, 4);
  if (series.frames_per_point > 1) addBand(chart, i => low[i], i => high[i], "envelope f-ok");
  addDots(chart, chart.points.filter(i => isKnown(refused[i])), refused, "f-bad",
    series.frames_per_point > 1 ? 1.5 : 2.5);
  addLine(chart, values, "ok");
  chart.body.append("line").attr({class: "gate", x2: chart.width, y1: chart.y(gate),
    y2: chart.y(gate)});
  closeChart(id, chart);
  legend(legendId, [["line", "ok", "accepted"], ["dot", "bad", "rejected"],
    ["dashed", "gate", "gate " + gate]]);
}

function drawRefusals() {
  byId("refusals-title").hidden = byId("refusals").hidden = !data.reasons.length;
  if (!data.reasons.length) return;
  const lane = 34, lanes = data.reasons.map(reason => reason.status);
  const chart = timeChart("refusals", lanes.length * lane + timeMargin.top + timeMargin.bottom,
    null, "Rejected shifts over time");
  const bars = lanes.map(() => "");
  const width = Math.max(2, chart.width / Math.max(chart.points.length, 1));
  for (const i of chart.points) {
    if (!refusals.has(i)) continue;
    for (const [status, n] of Object.entries(refusals.get(i))) {
      const row = lanes.indexOf(status);
      // The height is the share of the point's frames, never too small to be seen.
      const height = Math.max(3, 13 * Math.min(n / series.frames_per_point, 1));
      bars[row] += "M" + (chart.x(series.t_s[i]) - width / 2) + "," + (row + 1) * lane + "h" +
        width + "v-" + height + "h-" + width + "z";
    }
  }
  lanes.forEach((status, row) => {
    chart.frame.append("text").attr({class: "label", x: 6, y: row * lane + 14}).text(status);
    chart.body.append("path").attr({class: "f-bad", d: bars[row]});
  });
  closeChart("refusals", chart);
}

function drawTimeCharts() {
  drawVelocity();
  drawQuality("quality", "q-legend", "q", settings.min_q, "Q", 0);
  drawQuality("zncc", "zncc-legend", "zncc", settings.min_zncc, "ZNCC", 1);
  drawRefusals();
  byId("time-note").textContent = series.frames_per_point > 1 ?
    "The run is too long to draw every frame: each point stands for " +
    count(series.frames_per_point) + " frames and shows their mean, with the lowest and highest " +
    "value shaded. Every rejected shift still shows: the height of a bar is the share of the " +
    "point's frames. The CSV and JSON Lines outputs hold every frame." : "Every frame is drawn. Lines break where shifts were rejected.";
}
