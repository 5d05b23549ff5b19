// A figure: curves and dots on a canvas, which is quick with many points; axes, markers and labels above it in SVG.

const dashLengths = { solid: [], dashed: [14, 8], dotted: [3, 5] };
const markerRadius = 0.25;  // of a marker of size 1, in units of the font's size
const paperWidth = 1200;    // that widths of lines are for
const paperFont = 27;       // of a picture of that width
const labelFont = 14;       // pixels, as in the style sheet
const labelFontRatio = 0.85;  // of labels on paper, beside the axes' font
const reach = 30;           // pixels from the pointer to what it means

/** Corners of symbols on a circle of radius 1, y downwards; nothing for round ones. */
const symbolCorners = {
  square: [[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]],
  diamond: [[0, -1.3], [1.3, 0], [0, 1.3], [-1.3, 0]],
  triangle: [[0, -1.3], [1.15, 0.75], [-1.15, 0.75]],
  reversed_triangle: [[0, 1.3], [1.15, -0.75], [-1.15, -0.75]],
  pentagon: [0, 1, 2, 3, 4].map(function (k) {
    return [1.15 * Math.sin(2 * Math.PI * k / 5), -1.15 * Math.cos(2 * Math.PI * k / 5)];
  })
};

function symbolPath(look, radius) {
  const corners = symbolCorners[look.symbol];
  if (corners)
    return "M" + corners.map(function (c) { return radius * c[0] + "," + radius * c[1]; }).join("L") + "Z";
  const r = look.symbol === "dot" ? 0.55 * radius : radius;
  return "M" + r + ",0A" + r + "," + r + " 0 1 1 " + -r + ",0A" + r + "," + r + " 0 1 1 " + r + ",0Z";
}

function isFilled(look) {
  return look.filled || look.symbol === "dot";
}

/** #rrggbb of a number between the stops of a palette. */
function paletteColour(palette) {
  const scale = d3.scale.linear().clamp(true)
      .domain(palette.stops.map(function (stop) { return stop[0]; }))
      .range(palette.stops.map(function (stop) { return stop[1]; }));
  return scale;
}

/** The key of a figure as a line of HTML. */
function drawKey(host, figure) {
  if (!figure.key.length) return;
  const key = element("div", "key");
  figure.key.forEach(function (entry) {
    const item = element("span");
    const svg = d3.select(item).append("svg").attr("width", entry.stroke ? 38 : 16).attr("height", 16)
        .attr("aria-hidden", "true");
    if (entry.stroke)
      svg.append("line").attr("x1", 1).attr("x2", 37).attr("y1", 8).attr("y2", 8).attr("stroke", entry.stroke.colour)
          .attr("stroke-width", 0.7 * entry.stroke.width)
          .attr("stroke-dasharray", dashLengths[entry.stroke.dash].map(function (d) { return 0.6 * d; }).join(",") || null);
    if (entry.marker)
      drawSymbol(svg.append("g").attr("transform", "translate(" + (entry.stroke ? 19 : 8) + ",8)"), entry.marker, 5);
    const text = element("span");
    appendLabel(text, entry.text);
    item.appendChild(text);
    key.appendChild(item);
  });
  host.appendChild(key);
}

function drawSymbol(group, look, radius) {
  group.append("path").attr("d", symbolPath(look, radius * look.size)).attr("fill", isFilled(look) ? look.colour : "#fff")
      .attr("stroke", look.colour === "palette" ? "#000" : look.colour).attr("stroke-width", 1.5);
}

/**
 * Draws `figure` into `host`. `actions`: open(point) for a click on computed point k of a panel, tip(content, x, y)
 * and hideTip(). Returns the picture: panels, resize(), redraw(), zoomBy(factor), moveBy(x, y), reset(), choose(point).
 */
function makePicture(figure, host, actions) {
  const picture = { figure: figure, chosen: null };
  if (figure.title.t && data.figures.length > 1) appendLabel(host.appendChild(element("div", "picture-title")), figure.title);
  if (figure.note.t) appendLabel(host.appendChild(element("div", "picture-note")), figure.note);
  drawKey(host, figure);
  const plot = host.appendChild(element("div", "plot"));
  plot.tabIndex = 0;
  plot.setAttribute("role", "group");
  plot.setAttribute("aria-label", describe(figure));
  const canvas = plot.appendChild(document.createElement("canvas"));
  canvas.setAttribute("aria-hidden", "true");
  const svg = d3.select(plot).append("svg");
  const colours = figure.palette ? paletteColour(figure.palette) : null;
  const hasBar = figure.palette && figure.palette.bar;

  picture.panels = figure.panels.map(function (data, k) {
    const panel = { data: data, k: k, isLast: k === figure.panels.length - 1 };
    panel.x = (data.x.log ? d3.scale.log() : d3.scale.linear()).domain([data.x.low, data.x.high]);
    panel.y = (data.y.log ? d3.scale.log() : d3.scale.linear()).domain([data.y.low, data.y.high]);
    panel.group = svg.append("g");
    panel.clip = panel.group.append("clipPath").attr("id", "panel" + (++makePicture.count)).append("rect");
    panel.xAxis = panel.group.append("g").attr("class", "axis");
    panel.yAxis = panel.group.append("g").attr("class", "axis");
    panel.xLabel = panel.group.append("text").attr("text-anchor", "middle");
    panel.yLabel = panel.group.append("text").attr("text-anchor", "middle");
    panel.frame = panel.group.append("rect").attr("class", "frame");
    panel.area = panel.group.append("rect").attr("class", "area");
    panel.chosen = panel.group.append("circle").attr("class", "chosen").attr("r", 9).attr("visibility", "hidden");
    panel.markers = panel.group.append("g").selectAll("g").data(data.markers).enter().append("g").attr("class", "marker");
    panel.image = data.field ? fieldImage(data.field, colours) : null;
    panel.zoom = d3.behavior.zoom().on("zoom", function () { follow(panel); later(); })
        .on("zoomend", function () { layOut(); later(); });
    panel.group.call(panel.zoom).on("dblclick.zoom", null);
    prepareMarkers(panel);
    return panel;
  });
  const bar = hasBar ? makeBar(svg, figure.palette) : null;

  function prepareMarkers(panel) {
    panel.markers.each(function (marker) {
      const group = d3.select(this);
      const isLabel = marker.point !== null;
      if (isLabel)
        group.attr("tabindex", 0).attr("role", "button").attr("aria-label", actions.describe(panel, marker));
      group.append("circle").attr("class", "focus").attr("r", 11);
      group.append("path").attr("class", "symbol");
      if (marker.label.t) setSvgLabel(group.append("text").attr("text-anchor", "middle").node(), marker.label);
      if (!isLabel) return;
      group.on("click", function () {
        if (d3.event.defaultPrevented) return;
        d3.event.stopPropagation();
        actions.open(picture, panel, marker.point);
      });
      group.on("keydown", function () {
        if (d3.event.key !== "Enter" && d3.event.key !== " ") return;
        d3.event.preventDefault();
        actions.open(picture, panel, marker.point);
      });
    });
  }

  /** Other panels of the figure have the same x. */
  function follow(panel) {
    picture.panels.forEach(function (other) {
      if (other === panel) return;
      other.x.domain(panel.x.domain());
      rebind(other);
    });
  }

  /** Zooming by D3 starts at the domains that the scales have now. */
  function rebind(panel) {
    panel.zoom.x(panel.x).y(panel.y).scaleExtent(zoomLimits(panel));
  }

  // Places ----------------------------------------------------------------------------------------------------------

  function layOut() {
    const width = Math.max(plot.clientWidth, 200);
    const isNarrow = width < 520;
    const ratio = isNarrow ? Math.max(figure.height / figure.width, 0.95) : figure.height / figure.width;
    const tallest = isNarrow ? 1e9 : Math.max(320, window.innerHeight - 170);
    const height = Math.round(Math.min(width * ratio, tallest));
    picture.unit = Math.min(1, Math.max(0.5, width / paperWidth));
    picture.font = Math.max(14, paperFont * picture.unit);
    const numberWidth = d3.max(picture.panels, function (panel) {
      panel.y.range([height / figure.panels.length, 0]);
      const tics = ticsOf(panel.y, panel.data.y.log, Math.max(2, height / figure.panels.length / 50));
      return d3.max(tics.values, function (v) { return tics.text(v).length; }) || 1;
    });
    const left = 38 + 8 * numberWidth, right = hasBar ? 92 : 28, top = 10, bottom = 48, gap = 12;
    const frameHeight = (height - top - bottom - gap * (picture.panels.length - 1)) / picture.panels.length;
    picture.width = width;
    picture.height = height;
    plot.style.height = height + "px";
    const ratioOfPixels = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratioOfPixels);
    canvas.height = Math.round(height * ratioOfPixels);
    picture.panels.forEach(function (panel, k) {
      const box = { left: left, top: top + k * (frameHeight + gap), width: width - left - right, height: frameHeight };
      panel.box = box;
      panel.x.range([box.left, box.left + box.width]);
      panel.y.range([box.top + box.height, box.top]);
      if (panel.data.equal) equalise(panel.x, panel.y);
      rebind(panel);
      [panel.frame, panel.area, panel.clip].forEach(function (rectangle) {
        rectangle.attr("x", box.left).attr("y", box.top).attr("width", box.width).attr("height", box.height);
      });
      setSvgLabel(panel.yLabel.attr("transform", "translate(17," + (box.top + box.height / 2) + ") rotate(-90)").node(),
                  panel.data.y.label);
      setSvgLabel(panel.xLabel.attr("x", box.left + box.width / 2).attr("y", height - 8).node(),
                  panel.isLast ? panel.data.x.label : { t: "" });
    });
    if (bar) bar.place(width - right + 14, top, height - top - bottom);
  }

  // Drawing ---------------------------------------------------------------------------------------------------------

  let isWaiting = false;
  function later() {
    if (isWaiting) return;
    isWaiting = true;
    requestAnimationFrame(function () { isWaiting = false; redraw(); });
  }

  function redraw() {
    const context = canvas.getContext("2d");
    const scale = canvas.width / picture.width;
    context.setTransform(scale, 0, 0, scale, 0, 0);
    context.clearRect(0, 0, picture.width, picture.height);
    picture.panels.forEach(function (panel) {
      context.save();
      context.beginPath();
      context.rect(panel.box.left, panel.box.top, panel.box.width, panel.box.height);
      context.clip();
      if (panel.image) drawField(context, panel);
      panel.data.clouds.forEach(function (cloud) { drawCloud(context, panel, cloud); });
      panel.data.curves.forEach(function (curve) { drawCurve(context, panel, curve); });
      panel.data.arrows.forEach(function (arrow) { drawArrow(context, panel, arrow); });
      panel.data.symbols.forEach(function (symbol) { drawPlainSymbol(context, panel, symbol); });
      context.restore();
      drawAxes(panel);
      placeMarkers(panel);
      showChosen(panel);
    });
  }

  function drawField(context, panel) {
    const field = panel.data.field;
    const half = [halfCell(field.first[0], field.last[0], field.columns), halfCell(field.first[1], field.last[1], field.rows)];
    const x0 = panel.x(field.first[0] - half[0]), x1 = panel.x(field.last[0] + half[0]);
    const y0 = panel.y(field.first[1] - half[1]), y1 = panel.y(field.last[1] + half[1]);
    context.save();
    context.imageSmoothingEnabled = false;
    context.translate(x0, y0);
    context.scale((x1 - x0) / field.columns, (y1 - y0) / field.rows);
    context.drawImage(panel.image, 0, 0);
    context.restore();
  }

  function drawCloud(context, panel, cloud) {
    const points = cloud.points, radius = Math.max(0.7, cloud.size * markerRadius * picture.font * 0.8);
    const box = panel.box, x = panel.x, y = panel.y;
    context.fillStyle = cloud.levels ? "#000" : cloud.colour;
    for (let k = 0; k < points.length; k += 2) {
      const px = x(points[k]), py = y(points[k + 1]);
      if (!(px >= box.left - 3 && px <= box.left + box.width + 3 && py >= box.top - 3 && py <= box.top + box.height + 3))
        continue;
      if (cloud.levels) {
        const level = cloud.levels[k / 2];
        if (level === null) continue;
        context.fillStyle = colours(level);
      }
      if (radius < 1.3) context.fillRect(px - radius, py - radius, 2 * radius, 2 * radius);
      else {
        context.beginPath();
        context.arc(px, py, radius, 0, 2 * Math.PI);
        context.fill();
      }
    }
  }

  function drawCurve(context, panel, curve) {
    const points = curve.points, stroke = curve.stroke;
    const dashScale = curve.dashScale * picture.unit;
    context.strokeStyle = stroke.colour;
    context.lineWidth = Math.max(0.8, stroke.width * picture.unit);
    context.setLineDash(dashLengths[stroke.dash].map(function (length) { return length * dashScale; }));
    context.lineJoin = "round";
    context.beginPath();
    tracePieces(context, panel, points);
    context.stroke();
    context.setLineDash([]);
  }

  /** The lines from each point to the next; what is far outside the frame costs time and, with dashes, memory. */
  function tracePieces(context, panel, points) {
    const box = panel.box, margin = 1000;
    const area = { left: box.left - margin, right: box.left + box.width + margin, top: box.top - margin,
                   bottom: box.top + box.height + margin };
    let x0 = NaN, y0 = NaN, endX = NaN, endY = NaN;
    for (let k = 0; k < points.length; k += 2) {
      const x1 = points[k] === null ? NaN : panel.x(points[k]), y1 = points[k] === null ? NaN : panel.y(points[k + 1]);
      const part = isFinite(x0 + y0 + x1 + y1) ? partInside(x0, y0, x1, y1, area) : null;
      if (part) {
        if (part[0] !== endX || part[1] !== endY) context.moveTo(part[0], part[1]);
        context.lineTo(part[2], part[3]);
        endX = part[2];
        endY = part[3];
      }
      x0 = x1;
      y0 = y1;
    }
  }

  function drawArrow(context, panel, arrow) {
    const x0 = panel.x(arrow.points[0]), y0 = panel.y(arrow.points[1]);
    const x1 = panel.x(arrow.points[2]), y1 = panel.y(arrow.points[3]);
    const angle = Math.atan2(y1 - y0, x1 - x0), length = 0.6 * picture.font;
    context.fillStyle = arrow.colour;
    context.beginPath();
    context.moveTo(x1, y1);
    context.lineTo(x1 - length * Math.cos(angle - 0.32), y1 - length * Math.sin(angle - 0.32));
    context.lineTo(x1 - length * Math.cos(angle + 0.32), y1 - length * Math.sin(angle + 0.32));
    context.fill();
  }

  function drawPlainSymbol(context, panel, marker) {
    const look = marker.look;
    context.save();
    context.translate(panel.x(marker.x), panel.y(marker.y));
    const path = new Path2D(symbolPath(look, look.size * markerRadius * picture.font));
    context.fillStyle = isFilled(look) ? look.colour : "#fff";
    context.strokeStyle = look.colour;
    context.lineWidth = 1.5;
    context.fill(path);
    context.stroke(path);
    context.restore();
  }

  function drawAxes(panel) {
    const box = panel.box;
    const xTics = ticsOf(panel.x, panel.data.x.log, Math.max(2, Math.floor(box.width / 95)));
    const yTics = ticsOf(panel.y, panel.data.y.log, Math.max(2, Math.floor(box.height / 50)));
    const bare = function () { return ""; };
    panel.xAxis.attr("transform", "translate(0," + (box.top + box.height) + ")")
        .call(d3.svg.axis().scale(panel.x).orient("bottom").tickValues(xTics.values).innerTickSize(-6).outerTickSize(0)
            .tickPadding(7).tickFormat(panel.isLast ? xTics.text : bare));
    panel.yAxis.attr("transform", "translate(" + box.left + ",0)")
        .call(d3.svg.axis().scale(panel.y).orient("left").tickValues(yTics.values).innerTickSize(-6).outerTickSize(0)
            .tickPadding(7).tickFormat(yTics.text));
  }

  // Markers and labels ----------------------------------------------------------------------------------------------

  function placeMarkers(panel) {
    const box = panel.box, taken = [], shown = [];
    panel.markers.each(function (marker) {
      const x = panel.x(marker.x), y = panel.y(marker.y);
      const isInside = x >= box.left - 1 && x <= box.left + box.width + 1 && y >= box.top - 1 && y <= box.top + box.height + 1;
      const group = d3.select(this).style("display", isInside ? null : "none");
      if (!isInside) return;
      const radius = marker.look.size * markerRadius * picture.font;
      group.attr("transform", "translate(" + x + "," + y + ")");
      group.select(".symbol").attr("d", symbolPath(marker.look, radius)).attr("stroke-width", 1.5)
          .attr("fill", isFilled(marker.look) ? marker.look.colour : "#fff").attr("stroke", marker.look.colour);
      taken.push({ left: x - radius, right: x + radius, top: y - radius, bottom: y + radius, of: marker });
      shown.push({ marker: marker, x: x, y: y, radius: radius, text: group.select("text") });
    });
    const labels = [];
    shown.forEach(function (item) { placeLabel(panel, item, taken, labels); });
  }

  /** Where the picture on paper has the label, else at the first free place around the marker; nowhere if there is none. */
  function placeLabel(panel, item, taken, labels) {
    if (item.text.empty()) return;
    const node = item.text.node();
    if (!item.marker.size) {
      item.text.style("display", null);
      const box = node.getBBox();
      item.marker.size = { width: box.width, height: box.height };
    }
    const width = item.marker.size.width, height = item.marker.size.height, name = plainLabel(item.marker.label);
    const isRepeated = labels.some(function (label) {
      return label.name === name && Math.abs(label.x - item.x) < 1.2 * width && Math.abs(label.y - item.y) < 1.2 * height;
    });
    let best = null;
    (isRepeated ? [] : candidates(item, width, height)).forEach(function (place, k) {
      const area = { left: item.x + place[0] - width / 2, right: item.x + place[0] + width / 2,
                     top: item.y + place[1] - height / 2 + 3, bottom: item.y + place[1] + height / 2 - 3 };
      if (area.left < panel.box.left + 2 || area.right > panel.box.left + panel.box.width - 2 ||
          area.top < panel.box.top || area.bottom > panel.box.top + panel.box.height)
        return;
      const room = clearance(area, taken, item.marker);
      const cost = k - Math.min(room, 12);
      if (room > 0 && (!best || cost < best.cost)) best = { place: place, area: area, cost: cost };
    });
    item.text.style("display", best ? null : "none");
    if (!best) return;
    taken.push(best.area);
    item.text.attr("x", best.place[0]).attr("y", best.place[1] + 0.35 * labelFont);
    labels.push({ name: name, x: item.x, y: item.y });
  }

  /** The distance from a label to what is nearest of the others; 0 when it covers something. */
  function clearance(area, taken, own) {
    return taken.reduce(function (least, other) {
      const dx = Math.max(0, other.left - area.right, area.left - other.right);
      const dy = Math.max(0, other.top - area.bottom, area.top - other.bottom);
      const isTouched = dx === 0 && dy === 0;
      return other.of === own && !isTouched ? least : Math.min(least, Math.sqrt(dx * dx + dy * dy));
    }, Infinity);
  }

  function candidates(item, width, height) {
    const dx = item.radius + 4 + width / 2, dy = item.radius + 1 + height / 2;
    const around = [[dx, -0.6 * dy], [-dx, -0.6 * dy], [0, -dy], [0, dy], [dx, 0.6 * dy], [-dx, 0.6 * dy], [dx, 0], [-dx, 0],
                    [dx, -1.6 * dy], [-dx, -1.6 * dy], [dx, 1.6 * dy], [-dx, 1.6 * dy]];
    if (!item.marker.offset) return around;
    const size = Math.max(picture.font, labelFont / labelFontRatio);
    return [[item.marker.offset[0] * size, -item.marker.offset[1] * size]].concat(around);
  }

  function showChosen(panel) {
    const computed = panel.data.computed;
    const isHere = picture.chosen && picture.chosen.panel === panel;
    panel.chosen.attr("visibility", isHere ? "visible" : "hidden");
    if (!isHere) return;
    const x = panel.x(computed.x[picture.chosen.point]), y = panel.y(computed.y[picture.chosen.point]);
    const box = panel.box;
    const isInside = x >= box.left && x <= box.left + box.width && y >= box.top && y <= box.top + box.height;
    panel.chosen.attr("cx", x).attr("cy", y).attr("visibility", isInside ? "visible" : "hidden");
  }

  // Pointer ---------------------------------------------------------------------------------------------------------

  picture.panels.forEach(function (panel) {
    panel.group.on("mousemove.tip", function () {
      const at = d3.mouse(panel.group.node());
      const found = nearest(panel, at);
      if (found) actions.tip(panel, found, d3.event.clientX, d3.event.clientY);
      else actions.hideTip();
    });
    panel.group.on("mouseleave.tip", actions.hideTip);
    panel.group.on("click.open", function () {
      if (d3.event.defaultPrevented) return;
      const found = nearest(panel, d3.mouse(panel.group.node()));
      if (found && found.point !== undefined) actions.open(picture, panel, found.point);
      else if (found) actions.pin(picture, panel, found);
    });
  });

  /** What is nearest to a place in pixels: {point} of a branch, {x, y} of a dot or a curve, or a cell; null: nothing. */
  function nearest(panel, at) {
    const data = panel.data, hasBranch = data.computed.x.length > 0;
    const search = { best: reach * reach, owner: null, k: 0 };
    const look = function (x, y, owner, k) {
      if (x === null || y === null) return;
      const dx = panel.x(x) - at[0], dy = panel.y(y) - at[1], distance = dx * dx + dy * dy;
      if (!(distance < search.best)) return;
      search.best = distance;
      search.owner = owner;
      search.k = k;
    };
    const lookAlong = function (owner) {
      for (let k = 0; k < owner.points.length / 2; ++k) look(owner.points[2 * k], owner.points[2 * k + 1], owner, k);
    };
    data.computed.x.forEach(function (x, k) { look(x, data.computed.y[k], data.computed, k); });
    data.clouds.forEach(lookAlong);
    if (!hasBranch) {
      data.curves.filter(function (curve) { return !curve.background; }).forEach(lookAlong);
      data.markers.forEach(function (marker) { look(marker.x, marker.y, { points: [marker.x, marker.y] }, 0); });
    }
    if (search.owner) return search.owner === data.computed ? { point: search.k } : placeIn(search.owner, search.k);
    return data.field ? cellAt(panel, at) : null;
  }

  /** Point k of a cloud, a curve or a marker. */
  function placeIn(owner, k) {
    return { x: owner.points[2 * k], y: owner.points[2 * k + 1], colour: owner.levels === null ? owner.colour : "",
             level: owner.levels ? owner.levels[k] : null, origin: originOf(owner.from, k) };
  }

  function cellAt(panel, at) {
    const field = panel.data.field;
    const place = function (value, first, last, count) {
      return count > 1 ? Math.round((value - first) / (last - first) * (count - 1)) : 0;
    };
    const i = place(panel.x.invert(at[0]), field.first[0], field.last[0], field.columns);
    const j = place(panel.y.invert(at[1]), field.first[1], field.last[1], field.rows);
    if (i < 0 || j < 0 || i >= field.columns || j >= field.rows) return null;
    const centre = function (k, first, last, count) { return count > 1 ? first + (last - first) * k / (count - 1) : first; };
    return { x: rounded(centre(i, field.first[0], field.last[0], field.columns)),
             y: rounded(centre(j, field.first[1], field.last[1], field.rows)), level: field.cells[j * field.columns + i],
             origin: originOf(field.from, j * field.columns + i) };
  }

  // What others ask of a picture ------------------------------------------------------------------------------------

  function changeDomains(change) {
    picture.panels.forEach(function (panel) {
      panel.x.domain(change(panel.x, panel.box.left, panel.box.left + panel.box.width, true));
      panel.y.domain(change(panel.y, panel.box.top + panel.box.height, panel.box.top, false));
      rebind(panel);
    });
    layOut();
    redraw();
  }

  picture.plot = plot;
  picture.redraw = redraw;
  picture.nearest = nearest;
  picture.resize = function () { layOut(); redraw(); };
  picture.zoomBy = function (factor) {
    picture.panels.forEach(function (panel) {
      const limits = zoomLimits(panel);
      factor = Math.max(limits[0], Math.min(limits[1], factor));
    });
    changeDomains(function (scale, from, to) {
      const middle = (from + to) / 2;
      return [scale.invert(middle + (from - middle) / factor), scale.invert(middle + (to - middle) / factor)];
    });
  };
  /** By parts of the frame, x to the right and y upwards. */
  picture.moveBy = function (x, y) {
    changeDomains(function (scale, from, to, isAcross) {
      const by = (isAcross ? x : y) * (to - from);
      return [scale.invert(from + by), scale.invert(to + by)];
    });
  };
  picture.reset = function () {
    picture.panels.forEach(function (panel) {
      panel.x.domain([panel.data.x.low, panel.data.x.high]);
      panel.y.domain([panel.data.y.low, panel.data.y.high]);
    });
    picture.resize();
  };
  picture.choose = function (panel, point) {
    picture.chosen = panel ? { panel: panel, point: point } : null;
    redraw();
  };
  layOut();
  redraw();
  return picture;
}
makePicture.count = 0;

/**
 * The least and the largest factor by which a panel may still be enlarged: numbers have 16 digits, and nothing is to be
 * seen far outside.
 */
function zoomLimits(panel) {
  const finest = 1e-10, widest = 100;
  const size = function (domain, isLogarithmic) {
    return Math.abs(isLogarithmic ? Math.log(domain[1] / domain[0]) : domain[1] - domain[0]);
  };
  const axes = [[panel.x, panel.data.x], [panel.y, panel.data.y]].map(function (pair) {
    const domain = pair[0].domain(), now = size(domain, pair[1].log);
    const values = pair[1].log ? 1 : Math.max(Math.abs(domain[0]), Math.abs(domain[1]));
    const whole = size([pair[1].low, pair[1].high], pair[1].log);
    return { out: now / ((pair[1].log ? 3 : widest) * whole), into: now / (finest * Math.max(values, 1e-3 * whole)) };
  });
  return [Math.min(1, Math.max(axes[0].out, axes[1].out)), Math.max(1, Math.min(axes[0].into, axes[1].into))];
}

/** The part of a line that is inside an area, [x0, y0, x1, y1] (after Liang and Barsky); null when none is. */
function partInside(x0, y0, x1, y1, area) {
  const dx = x1 - x0, dy = y1 - y0;
  let from = 0, to = 1;
  const isOutside = [[-dx, x0 - area.left], [dx, area.right - x0], [-dy, y0 - area.top], [dy, area.bottom - y0]]
      .some(function (edge) {
        const speed = edge[0], room = edge[1];
        if (speed === 0) return room < 0;
        if (speed < 0) from = Math.max(from, room / speed);
        else to = Math.min(to, room / speed);
        return from > to;
      });
  if (isOutside) return null;
  return [from > 0 ? x0 + from * dx : x0, from > 0 ? y0 + from * dy : y0,
          to < 1 ? x0 + to * dx : x1, to < 1 ? y0 + to * dy : y1];
}

/** The row of a sweep that a dot or a cell is from; null for what is from elsewhere. */
function originOf(from, k) {
  return from && from.rows[k] !== null ? { sweep: from.sweep, row: from.rows[k] } : null;
}

function rounded(value) {
  return Number(value.toPrecision(12));
}

function halfCell(first, last, count) {
  return count > 1 ? (last - first) / (count - 1) / 2 : 0.5;
}

/** One pixel for each cell. */
function fieldImage(field, colours) {
  const image = document.createElement("canvas");
  image.width = field.columns;
  image.height = field.rows;
  const context = image.getContext("2d");
  const pixels = context.createImageData(field.columns, field.rows);
  field.cells.forEach(function (cell, k) {
    if (cell === null) return;
    const colour = d3.rgb(colours(cell));
    pixels.data.set([colour.r, colour.g, colour.b, 255], 4 * k);
  });
  context.putImageData(pixels, 0, 0);
  return image;
}

/** The strip of colours at the right edge. */
function makeBar(svg, palette) {
  const group = svg.append("g");
  const low = palette.stops[0][0], high = palette.stops[palette.stops.length - 1][0];
  const gradient = group.append("linearGradient").attr("id", "palette" + makePicture.count)
      .attr("x1", 0).attr("x2", 0).attr("y1", 1).attr("y2", 0);
  palette.stops.forEach(function (stop) {
    gradient.append("stop").attr("offset", high > low ? (stop[0] - low) / (high - low) : 0).attr("stop-color", stop[1]);
  });
  const strip = group.append("rect").attr("width", 16).attr("fill", "url(#palette" + makePicture.count + ")")
      .attr("stroke", "#000");
  const axis = group.append("g").attr("class", "axis");
  const label = group.append("text").attr("text-anchor", "middle");
  setSvgLabel(label.node(), palette.label);
  return {
    place: function (left, top, height) {
      const scale = d3.scale.linear().domain([low, high]).range([top + height, top]);
      const tics = ticsOf(scale, false, Math.max(2, Math.floor(height / 60)));
      strip.attr("x", left).attr("y", top).attr("height", height);
      axis.attr("transform", "translate(" + (left + 16) + ",0)")
          .call(d3.svg.axis().scale(scale).orient("right").tickValues(tics.values).tickFormat(tics.text).outerTickSize(0)
              .innerTickSize(4));
      label.attr("transform", "translate(" + (left + 72) + "," + (top + height / 2) + ") rotate(-90)");
    }
  };
}

function describe(figure) {
  const panel = figure.panels[0];
  const labels = d3.sum(figure.panels, function (one) { return one.markers.length; });
  return "Diagram: " + plainLabel(panel.y.label) + " over " + plainLabel(panel.x.label) + ", with " + labels +
         " labels. Press ? for the keys.";
}
