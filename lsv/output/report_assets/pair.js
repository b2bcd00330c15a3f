// SPDX-License-Identifier: BSD-3-Clause
// The correlation plane of one pair, its 7 x 7 neighbourhood, and the frame.
const viridis = d3.scale.linear()
  .domain(d3.range(0, 1.01, 0.1))
  .range(["#440154", "#482576", "#414487", "#35608d", "#2a788e", "#21918c", "#22a884", "#43bf71",
    "#7ad151", "#bddf26", "#fde725"])
  .clamp(true);
const mapMargin = {top: 4, right: 8, bottom: 74, left: 46};

// Cells painted one pixel each, as the address of a PNG.
function paint(columns, rows, colourAt) {
  const canvas = document.createElement("canvas");
  canvas.width = columns;
  canvas.height = rows;
  const context = canvas.getContext("2d");
  const pixels = context.createImageData(columns, rows);
  for (let i = 0; i < columns * rows; ++i) {
    const colour = colourAt(i);
    pixels.data.set([colour.r, colour.g, colour.b, 255], 4 * i);
  }
  context.putImageData(pixels, 0, 0);
  return canvas.toDataURL();
}

function addFigure(title, more) {
  const figure = add(byId("pair"), "figure");
  const caption = add(figure, "figcaption", title + " ");
  add(caption, "span", more);
  const box = add(figure, "div", undefined, "chart");
  box.id = "figure-" + byId("pair").children.length;
  return box.id;
}

function addPixels(parent, address, width, height) {
  parent.append("image").attr({class: "pixels", width: width, height: height,
    preserveAspectRatio: "none"}).attr("href", address);
}

function crossAt(g, x, y) {
  const mark = "M-9,0h5M4,0h5M0,-9v5M0,4v5M4,0a4,4 0 1,1 -8,0a4,4 0 1,1 8,0";
  for (const layer of ["peak-halo", "peak-mark"]) {
    g.append("path").attr({class: layer, d: mark, transform: "translate(" + x + "," + y + ")"});
  }
}

// `map`: first_dx_px, first_dy_px, columns, rows, reduction, values.
function drawMap(id, map, plane, colour, withNumbers) {
  const width = Math.min(widthOf(id), 380), margin = mapMargin;
  const cell = Math.min((width - margin.left - margin.right) / map.columns, 330 / map.rows);
  const inner = {width: cell * map.columns, height: cell * map.rows};
  const height = inner.height + margin.top + margin.bottom;
  const svg = newSvg(id, width, height, "Correlation over the lags");
  const g = svg.append("g").attr("transform", "translate(" + margin.left + "," + margin.top + ")");
  const black = d3.rgb("#808080");
  addPixels(g, paint(map.columns, map.rows, i => isKnown(map.values[i]) ?
    d3.rgb(colour(map.values[i])) : black), inner.width, inner.height);

  // A lag stands at the middle of its cell.
  const lagScale = (first, cells, length) => d3.scale.linear().range([0, length])
    .domain([first - 0.5, first - 0.5 + cells * map.reduction]);
  const x = lagScale(map.first_dx_px, map.columns, inner.width);
  const y = lagScale(map.first_dy_px, map.rows, inner.height);
  const ticks = withNumbers ? 7 : 5;
  g.append("g").attr({class: "axis", transform: "translate(0," + inner.height + ")"})
    .call(d3.svg.axis().scale(x).ticks(ticks).tickSize(4).tickFormat(d3.format("d")));
  g.append("g").attr("class", "axis")
    .call(d3.svg.axis().scale(y).orient("left").ticks(ticks).tickSize(4)
      .tickFormat(d3.format("d")));
  svg.append("text").attr({x: margin.left + inner.width / 2, y: margin.top + inner.height + 34,
    "text-anchor": "middle"}).text("lag dx (px)");
  svg.append("text").attr({transform: "translate(12," + (margin.top + inner.height / 2) +
    ") rotate(-90)", "text-anchor": "middle"}).text("lag dy (px)");
  if (withNumbers) writeCells(g, map, cell, colour);
  if (isKnown(plane.dx_px)) crossAt(g, x(plane.dx_px), y(plane.dy_px));
  drawColourBar(svg, margin.left, margin.top + inner.height + 44, inner.width, colour.domain(),
    id);
  g.append("rect").attr({class: "catcher", width: inner.width, height: inner.height})
    .on("mousemove", function () {
      const [mx, my] = d3.mouse(this);
      tellLag(map, Math.min(Math.floor(mx / cell), map.columns - 1),
        Math.min(Math.floor(my / cell), map.rows - 1));
    })
    .on("mouseout", () => tellLag(null));
}

function writeCells(g, map, cell, colour) {
  map.values.forEach((value, i) => {
    if (!isKnown(value)) return;
    g.append("text").attr("class", "cell").text(value.toFixed(2).replace("-", "\u2212"))
      .style("fill", d3.lab(colour(value)).l > 60 ? "#000" : "#fff")
      .attr({x: (i % map.columns + 0.5) * cell, y: (Math.floor(i / map.columns) + 0.5) * cell +
        (isPeakCell(map, i) ? 17 : 3.5)});
  });
}

// The number of the peak cell gives way to the mark.
function isPeakCell(map, i) {
  const plane = data.plane;
  return isKnown(plane.dx_px) &&
    Math.round(plane.dx_px) === map.first_dx_px + i % map.columns &&
    Math.round(plane.dy_px) === map.first_dy_px + Math.floor(i / map.columns);
}

function drawColourBar(svg, left, top, width, [low, high], id) {
  const gradient = svg.append("linearGradient").attr("id", id + "-bar");
  for (const share of d3.range(0, 1.01, 0.1)) {
    gradient.append("stop").attr({offset: share, "stop-color": viridis(share)});
  }
  svg.append("rect").attr({x: left, y: top, width: width, height: 8, fill: "url(#" + id + "-bar)"});
  const scale = d3.scale.linear().domain([low, high]).range([0, width]);
  svg.append("g").attr({class: "axis", transform: "translate(" + left + "," + (top + 8) + ")"})
    .call(d3.svg.axis().scale(scale).ticks(4).tickSize(3));
}

function tellLag(map, column, row) {
  const line = byId("lag-readout");
  if (!map) {
    line.textContent = "";
    return;
  }
  const range = (first, cell) => {
    const low = first + cell * map.reduction;
    return map.reduction > 1 ? low + " to " + (low + map.reduction - 1) : String(low);
  };
  line.textContent = "dx " + range(map.first_dx_px, column) + " px, dy " +
    range(map.first_dy_px, row) + " px: " + digits(map.values[row * map.columns + column]);
}

function correlationName(plane) {
  return plane.engine === "zncc" || plane.engine === "direct" ? "ZNCC" :
    plane.engine + " correlation";
}

function drawPlane(plane) {
  const range = extent(plane.map.values) || [0, 1];
  const colour = value => viridis((value - range[0]) / (range[1] - range[0] || 1));
  colour.domain = () => range;
  const name = correlationName(plane);
  drawMap(addFigure(name + " plane", plane.map.reduction > 1 ? "highest of " +
    plane.map.reduction + " \u00d7 " + plane.map.reduction + " lags per cell" : "every lag"),
  plane.map, plane, colour, false);
  drawMap(addFigure("Around the peak", name + " of each lag"), plane.near, plane, colour, true);
}

function drawImage(image) {
  const bytes = Uint8Array.from(atob(image.grey), c => c.charCodeAt(0));
  const [low, high] = extent(bytes);
  const grey = i => {
    const level = Math.round(255 * (bytes[i] - low) / (high - low || 1));
    return {r: level, g: level, b: level};
  };
  const id = addFigure("Frame " + count(image.frame), image.width_px * image.reduction + " \u00d7 " +
    image.height_px * image.reduction + " px, grey stretched");
  const width = Math.min(widthOf(id), 380), margin = {top: 24, right: 8, bottom: 8, left: 46};
  const cell = Math.min((width - margin.left - margin.right) / image.width_px,
    330 / image.height_px);
  const inner = {width: cell * image.width_px, height: cell * image.height_px};
  const svg = newSvg(id, width, inner.height + margin.top + margin.bottom, "The frame");
  const g = svg.append("g").attr("transform", "translate(" + margin.left + "," + margin.top + ")");
  addPixels(g, paint(image.width_px, image.height_px, grey), inner.width, inner.height);
  const arrow = "m-5,-3l5,3l-5,3";
  g.append("path").attr({class: "path s-x", d: "M0,-8h56" + arrow});
  g.append("text").attr({x: 62, y: -4}).text("+dx, +x");
  g.append("path").attr({class: "path s-y", d: "M-8,0v56m-3,-5l3,5l3,-5"});
  g.append("text").attr({transform: "translate(-5,62) rotate(-90)", "text-anchor": "end"})
    .text("+dy, +y");
}

function drawPair() {
  byId("pair").textContent = "";
  const plane = data.plane, image = data.image;
  if (!plane && !image) {
    byId("pair-note").textContent = "No correlation plane was kept in this run.";
    return;
  }
  if (plane) {
    byId("pair-title").textContent = "Pair ending at frame " + count(plane.frame);
    const shift = isKnown(plane.dx_px) ? ", sub-pixel peak at dx = " + plane.dx_px.toFixed(3)
      .replace("-", "\u2212") + " px, dy = " + plane.dy_px.toFixed(3).replace("-", "\u2212") + " px" :
      ", no shift accepted";
    byId("pair-note").textContent = "Engine " + plane.engine + ", status " + plane.status + shift +
      ".";
    drawPlane(plane);
  }
  if (image) drawImage(image);
}
