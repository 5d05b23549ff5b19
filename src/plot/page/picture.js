// A figure: curves and dots on a canvas, which is quick with many points; axes, markers and labels above it in SVG.

const dashLengths = { solid: [], dashed: [14, 8], dotted: [3, 5] };
const markerRadius = 0.25;  // of a marker of size 1, in units of the font's size
const paperWidth = 1200;    // that widths of lines are for
const paperFont = 27;       // of a picture of that width
const labelFont = 14;       // pixels, as in the style sheet
const labelFontRatio = 0.85;  // of labels on paper, beside the axes' font

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

/** Is a place in pixels in a frame, or at most `margin` outside? */
function isInside(box, x, y, margin) {
  return x >= box.left - margin && x <= box.left + box.width + margin && y >= box.top - margin &&
         y <= box.top + box.height + margin;
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
          .attr("stroke-dasharray", dashLengths[entry.stroke.dash].map(function (d) { return 0.6 * d; }).join(",") ||
                                    null);
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
  group.append("path").attr("d", symbolPath(look, radius * look.size))
      .attr("fill", isFilled(look) ? look.colour : "#fff").attr("stroke-width", 1.5)
      .attr("stroke", look.colour === "palette" ? "#000" : look.colour);
}

/**
 * Draws `figure` into `host`. `actions`: open(point) for a click on computed point k of a panel, tip(content, x, y)
 * and hideTip(). Returns the picture: panels, resize(), redraw(), zoomBy(factor), moveBy(x, y), reset(), choose(point).
 */
function makePicture(figure, host, actions) {
  const picture = { figure: figure, chosen: null, colours: figure.palette ? paletteColour(figure.palette) : null };
  const isOneOfMany = data.figures.length > 1;  // the title of a lone one is that of the page
  if (figure.title.t && isOneOfMany) appendLabel(host.appendChild(element("div", "picture-title")), figure.title);
  if (figure.note.t) appendLabel(host.appendChild(element("div", "picture-note")), figure.note);
  drawKey(host, figure);
  const plot = host.appendChild(element("div", "plot"));
  plot.tabIndex = 0;
  plot.setAttribute("role", "group");
  plot.setAttribute("aria-label", describe(figure));
  const canvas = plot.appendChild(document.createElement("canvas"));
  canvas.setAttribute("aria-hidden", "true");
  const svg = d3.select(plot).append("svg");
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
    panel.markers = panel.group.append("g").selectAll("g").data(data.markers).enter().append("g")
        .attr("class", "marker");
    panel.image = data.field ? fieldImage(data.field, picture.colours) : null;
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
      group.append("line").attr("class", "leader").style("display", "none");
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
      panel.data.clouds.forEach(function (cloud) { drawCloud(context, picture, panel, cloud); });
      panel.data.curves.forEach(function (curve) { drawCurve(context, picture, panel, curve); });
      panel.data.arrows.forEach(function (arrow) { drawArrow(context, picture, panel, arrow); });
      panel.data.symbols.forEach(function (symbol) { drawPlainSymbol(context, picture, panel, symbol); });
      context.restore();
      drawAxes(panel);
      placeMarkers(picture, panel);
      showChosen(panel);
    });
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

  function showChosen(panel) {
    const computed = panel.data.computed;
    const isHere = picture.chosen && picture.chosen.panel === panel;
    panel.chosen.attr("visibility", isHere ? "visible" : "hidden");
    if (!isHere) return;
    const x = panel.x(computed.x[picture.chosen.point]), y = panel.y(computed.y[picture.chosen.point]);
    panel.chosen.attr("cx", x).attr("cy", y).attr("visibility", isInside(panel.box, x, y, 0) ? "visible" : "hidden");
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
          .call(d3.svg.axis().scale(scale).orient("right").tickValues(tics.values).tickFormat(tics.text)
              .outerTickSize(0).innerTickSize(4));
      label.attr("transform", "translate(" + (left + 72) + "," + (top + height / 2) + ") rotate(-90)");
    }
  };
}

function describe(figure) {
  const panel = figure.panels[0];
  const labels = d3.sum(figure.panels, function (one) {
    return one.markers.filter(function (marker) { return marker.point !== null; }).length;
  });
  return "Diagram: " + plainLabel(panel.y.label) + " over " + plainLabel(panel.x.label) + ", with " + labels +
         (labels === 1 ? " label" : " labels") + ". Press ? for the keys.";
}
