// SPDX-License-Identifier: BSD-3-Clause
// The path in metres with equal axes, y downwards as in the image.
const trajectoryMargin = {top: 8, right: 14, bottom: 40, left: 58};

function drawTrajectory() {
  const shown = extent(series.x_m) && extent(series.y_m);
  if (!shown) return;
  const width = widthOf("trajectory"), margin = trajectoryMargin;
  const inner = {width: width - margin.left - margin.right};
  const box = {x: extent(series.x_m, [0]), y: extent(series.y_m, [0])};
  const size = Math.max(box.x[1] - box.x[0], box.y[1] - box.y[0]) || 1e-6;
  const room = 0.08 * size;
  const need = {x: box.x[1] - box.x[0] + 2 * room, y: box.y[1] - box.y[0] + 2 * room};
  inner.height = Math.min(Math.max(inner.width * need.y / need.x, 190), Math.min(460, inner.width));
  const perMetre = Math.min(inner.width / need.x, inner.height / need.y);

  const unit = scaleFor(size, "m");
  const scale = (range, length) => {
    const middle = (range[0] + range[1]) / 2, half = length / perMetre / 2;
    return d3.scale.linear().range([0, length])
      .domain([(middle - half) * unit.factor, (middle + half) * unit.factor]);
  };
  const x = scale(box.x, inner.width), y = scale(box.y, inner.height);
  const px = i => x(series.x_m[i] * unit.factor), py = i => y(series.y_m[i] * unit.factor);

  const svg = newSvg("trajectory", width, inner.height + margin.top + margin.bottom,
    "Trajectory in the sensor axes");
  const g = svg.append("g").attr("transform", "translate(" + margin.left + "," + margin.top + ")");
  const ticks = length => Math.max(3, Math.floor(length / 70));
  g.append("g").attr({class: "axis", transform: "translate(0," + inner.height + ")"})
    .call(d3.svg.axis().scale(x).ticks(ticks(inner.width)).tickSize(-inner.height).tickPadding(8));
  g.append("g").attr("class", "axis")
    .call(d3.svg.axis().scale(y).orient("left").ticks(ticks(inner.height)).tickSize(-inner.width)
      .tickPadding(8));
  g.append("rect").attr({class: "frame", width: inner.width, height: inner.height});
  svg.append("text").attr({x: margin.left + inner.width / 2, y: margin.top + inner.height + 34,
    "text-anchor": "middle"}).text("x (" + unit.unit + ")");
  svg.append("text").attr({transform: "translate(13," + (margin.top + inner.height / 2) +
    ") rotate(-90)", "text-anchor": "middle"}).text("y (" + unit.unit + "), down as in the image");

  const points = d3.range(series.t_s.length);
  const held = apart(points.filter(i => refusals.has(i)), px, py, 9);
  g.append("path").attr("class", "path s-bad").attr("d", held.map(i =>
    "M" + (px(i) - 4) + "," + (py(i) - 4) + "l8,8m0,-8l-8,8").join(""));
  g.append("path").datum(points).attr("class", "path s-ok")
    .attr("d", d3.svg.line().x(px).y(py).defined(i => isKnown(series.x_m[i])));
  markEnd(g, px(0), py(0), "start", "circle");
  markEnd(g, px(points.length - 1), py(points.length - 1), "end", "square");
  followMouse(g, inner, points, px, py);

  const gaps = held.length ? "\u00d7 marks where shifts were rejected: the position is held there " +
    "and motion during that time is not in the path. " : "";
  byId("trajectory-note").textContent = gaps + "Circle: start. Square: end.";
}

// Those of the points that are not within `distance` of the one kept before, so that marks do not
// run into each other.
function apart(points, px, py, distance) {
  let last = null;
  return points.filter(i => {
    const crowded = last !== null && Math.hypot(px(i) - px(last), py(i) - py(last)) < distance;
    if (!crowded) last = i;
    return !crowded;
  });
}

function markEnd(g, x, y, name, shape) {
  g.append("path").attr({class: "end f-ok", transform: "translate(" + x + "," + y + ")"})
    .attr("d", d3.svg.symbol().type(shape).size(90));
  const above = name === "start";
  g.append("text").attr({class: "label", x: x, y: y + (above ? -10 : 20), "text-anchor": "middle"})
    .text(name);
}

function followMouse(g, inner, points, px, py) {
  const dot = g.append("circle").attr({class: "cursor-dot", r: 4}).style("display", "none");
  onHover("trajectory", i => {
    dot.style("display", i === null ? "none" : null);
    if (i !== null) dot.attr({cx: px(i), cy: py(i)});
  });
  g.append("rect").attr({class: "catcher", width: inner.width, height: inner.height})
    .on("mousemove", function () {
      const [mx, my] = d3.mouse(this);
      const distance = i => (px(i) - mx) * (px(i) - mx) + (py(i) - my) * (py(i) - my);
      let nearest = 0;
      for (const i of points) if (distance(i) < distance(nearest)) nearest = i;
      hover(nearest);
    })
    .on("mouseout", () => hover(null));
}
