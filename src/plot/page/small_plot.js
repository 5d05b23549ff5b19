// Small plots beside the diagram: phase portraits, time series, multipliers.

const smallWidth = 460;

/** The ends of all values with a margin; a range of some size also where all are equal. */
function paddedRange(values, margin) {
  const low = d3.min(values), high = d3.max(values);
  const size = high - low > 1e-12 * Math.max(Math.abs(low), Math.abs(high)) ? high - low : Math.abs(high) || 1;
  return [low - margin * size, high + margin * size];
}

/**
 * An empty plot: {svg, x, y, inner}, an SVG element with axes, its scales, and the group to draw in. `settings` has
 * x, y {label, range}, height, title, isEqual (a unit is as long on both axes), hasNumbersBelow.
 */
function smallPlot(host, settings) {
  const bottom = settings.hasNumbersBelow === false ? 10 : 42, left = 68, right = 14, top = 8;
  const width = smallWidth - left - right, height = settings.height - top - bottom;
  const x = d3.scale.linear().domain(settings.x.range).range([left, left + width]);
  const y = d3.scale.linear().domain(settings.y.range).range([top + height, top]);
  if (settings.isEqual) equalise(x, y);
  const svg = d3.select(host).append("svg").attr("class", "small-plot").attr("role", "img")
      .attr("viewBox", "0 0 " + smallWidth + " " + settings.height).attr("aria-label", settings.title);
  const clip = "clip" + (++smallPlot.count);
  svg.append("clipPath").attr("id", clip).append("rect").attr("x", left).attr("y", top)
      .attr("width", width).attr("height", height);
  smallAxis(svg, x, "bottom", top + height, settings.hasNumbersBelow === false, 6);
  smallAxis(svg, y, "left", left, false, Math.max(2, Math.floor(height / 34)));
  if (settings.hasNumbersBelow !== false)
    setSvgLabel(svg.append("text").attr("text-anchor", "middle").attr("x", left + width / 2)
        .attr("y", settings.height - 6).node(), settings.x.label);
  setSvgLabel(svg.append("text").attr("text-anchor", "middle")
      .attr("transform", "translate(14," + (top + height / 2) + ") rotate(-90)").node(), settings.y.label);
  const inner = svg.append("g").attr("clip-path", "url(#" + clip + ")");
  svg.append("rect").attr("class", "frame").attr("x", left).attr("y", top).attr("width", width).attr("height", height);
  return { svg: svg, x: x, y: y, inner: inner, top: top, bottom: top + height };
}
smallPlot.count = 0;

function smallAxis(svg, scale, side, place, isBare, count) {
  const tics = ticsOf(scale, false, count);
  const axis = d3.svg.axis().scale(scale).orient(side).tickValues(tics.values).innerTickSize(-5).outerTickSize(0)
      .tickPadding(5).tickFormat(isBare ? function () { return ""; } : tics.text);
  svg.append("g").attr("class", "axis").call(axis)
      .attr("transform", side === "bottom" ? "translate(0," + place + ")" : "translate(" + place + ",0)");
}

/** Widens one domain so that a unit is as long on both axes. */
function equalise(x, y) {
  const unit = function (scale) {
    const domain = scale.domain(), range = scale.range();
    return Math.abs(domain[1] - domain[0]) / Math.abs(range[1] - range[0]);
  };
  const factor = unit(x) / unit(y);
  const wider = factor < 1 ? x : y, by = factor < 1 ? 1 / factor : factor;
  const domain = wider.domain(), middle = (domain[0] + domain[1]) / 2;
  wider.domain([middle - by * (middle - domain[0]), middle + by * (domain[1] - middle)]);
}

function drawLine(plot, xs, ys, className) {
  const line = d3.svg.line().x(function (k) { return plot.x(xs[k]); }).y(function (k) { return plot.y(ys[k]); });
  plot.inner.append("path").attr("class", className).attr("d", line(d3.range(xs.length)));
}

function drawDot(plot, x, y, radius, className, title) {
  const dot = plot.inner.append("circle").attr("class", className).attr("r", radius)
      .attr("cx", plot.x(x)).attr("cy", plot.y(y));
  if (title) dot.append("title").text(title);
}
