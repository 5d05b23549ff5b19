// What is known of one point: values, orbit, multipliers, the command that restarts there.

/** The facts of a point: its section, label and the label whose orbit is shown for it. */
function factsOf(data, place) {
  const branch = data.branches[place.branch], section = branch.sections[place.section];
  const label = section.labels[place.row] || null;
  const withOrbit = label && label.orbit !== null ? { row: place.row, label: label } : nearestOrbit(section, place.row);
  return {
    branch: branch, section: section, row: place.row, label: label, source: withOrbit,
    stability: { s: "stable", u: "unstable" }[section.stability[place.row]] || "",
    violation: section.inadmissible[place.row],
    title: label && label.type ? (label.name || label.type) + ", label " + label.label
         : label ? "label " + label.label : "point " + section.point[place.row]
  };
}

/** The labelled point of the same branch whose embedded orbit is fewest points away; null when there is none. */
function nearestOrbit(section, row) {
  let best = null;
  Object.keys(section.labels).forEach(function (key) {
    const distance = Math.abs(Number(key) - row);
    if (section.branch[key] !== section.branch[row]) return;
    if (section.labels[key].orbit === null || (best && distance >= best.distance)) return;
    best = { row: Number(key), label: section.labels[key], distance: distance };
  });
  return best;
}

function wordsOfStability(facts) {
  const words = [];
  if (facts.stability) words.push(facts.stability + (facts.label && facts.label.border ? " before this point" : ""));
  if (facts.violation !== undefined) words.push("inadmissible");
  return words.join(", ");
}

function valueOf(section, column, row) {
  return fullNumber(section.values[column][row]);
}

/** Names and values of all columns, and of the parameters that are fixed. */
function rowsOfValues(facts) {
  const rows = [["point", String(facts.section.point[facts.row])]];
  const words = wordsOfStability(facts);
  if (words) rows.push(["stability", words]);
  facts.section.columns.forEach(function (name, k) { rows.push([name, valueOf(facts.section, k, facts.row)]); });
  facts.section.fixed.forEach(function (pair) { rows.push([pair[0] + " (fixed)", fullNumber(pair[1])]); });
  return rows;
}

function addWarning(host, text) {
  host.appendChild(element("p", "warning", text));
}

/** A labelled point in one line: "PD1, label 8: alpha = 3.0361936". */
function lineOfLabel(section, row) {
  const label = section.labels[row];
  return (label.name || label.type || "point") + ", label " + label.label + ": " + section.columns[0] + " = " +
         shortNumber(section.values[0][row], 8);
}

/** What the page shows before a point is chosen: what to do, and the labels as a list. */
function showOverview(data, host, open, places) {
  host.textContent = "";
  if (!data.branches.length) {
    host.appendChild(element("p", "", "Point at a curve or a dot for its values; a click keeps them here."));
    return;
  }
  host.appendChild(element("h2", "", places.length ? "Labels" : "Points"));
  host.appendChild(element("p", "", "Choose a label, or click a point of the branch, for its orbit, its multipliers " +
                                    "and the command that restarts there."));
  data.branches.forEach(function (branch) {
    if (branch.noOrbits) addWarning(host, "Orbits: " + branch.noOrbits + ".");
    if (branch.noMultipliers)
      addWarning(host, nounOfSpectrum(branch.sections[0]) + " are not available: " + branch.noMultipliers + ".");
  });
  const list = element("ul", "labels");
  places.forEach(function (place) {
    const branch = data.branches[place.branch], section = branch.sections[place.section];
    const prefix = data.branches.length > 1 ? branch.name + ": " : "";
    const item = list.appendChild(element("li"));
    item.appendChild(button(prefix + lineOfLabel(section, place.row), function () { open(place); }));
  });
  host.appendChild(list);
}

/** All that a sweep says of one of its rows. */
function showSweepRow(sweep, host, row) {
  host.appendChild(element("h3", "", "Row " + (row + 1) + " of the sweep " + sweep.name));
  if (!sweep.values) {
    addWarning(host, "The sweep is too large for a page: its rows are in the file alone.");
    return;
  }
  const rows = sweep.columns.map(function (name, k) {
    const value = sweep.values[k][row];
    return [name, typeof value === "string" ? value : value === null ? "none" : fullNumber(value)];
  });
  sweep.fixed.forEach(function (pair) { rows.push([pair[0] + " (fixed)", fullNumber(pair[1])]); });
  host.appendChild(valueTable(rows, "values sweep-row"));
}

/** Fills `host` with all that is known of the point. */
function showPoint(data, host, place, close) {
  const facts = factsOf(data, place);
  host.textContent = "";
  const top = host.appendChild(element("div", "top"));
  top.appendChild(element("h2", "", facts.title + (data.branches.length > 1 ? " of " + facts.branch.name : "")));
  const closing = button("Close", close);
  closing.title = "Close (Esc)";
  top.appendChild(closing);
  if (facts.label && facts.label.type && facts.label.meaning)
    host.appendChild(element("p", "meaning", facts.label.type + ": " + facts.label.meaning + "."));
  if (facts.label && facts.label.kind) host.appendChild(element("p", "kind", facts.label.kind));
  if (facts.label && facts.label.form) host.appendChild(element("p", "form", facts.label.form));
  if (facts.violation !== undefined)
    addWarning(host, "The orbit violates the model" + (facts.violation ? ": " + facts.violation : "") + ".");
  host.appendChild(valueTable(rowsOfValues(facts), "values point-values"));
  showOrbitPart(host, facts);
  showMultipliers(host, facts);
  showRestart(host, facts);
  return facts;
}

// Orbits --------------------------------------------------------------------------------------------------------------

function showOrbitPart(host, facts) {
  host.appendChild(element("h3", "", "Orbit"));
  if (!facts.source) {
    addWarning(host, "Orbits are not available: " + (facts.branch.noOrbits || "no label of this branch has one") + ".");
    return;
  }
  const orbit = facts.branch.orbits[facts.source.label.orbit];
  if (facts.source.row !== facts.row) {
    const away = Math.abs(facts.source.row - facts.row);
    const why = facts.label && facts.label.restarts ? "The orbit of this label is not embedded in the page."
                                                    : "This point has no stored orbit.";
    addWarning(host, why + " Shown is the orbit of the nearest label, " +
                     lineOfLabel(facts.section, facts.source.row) + ", " + away + (away === 1 ? " point" : " points") +
                     " away.");
  }
  if (orbit.equilibrium) showEquilibrium(host, orbit, facts.section);
  else showOrbit(host, withReturnsFromZero(orbit), facts.section.states);
}

function showEquilibrium(host, orbit, section) {
  host.appendChild(element("p", "", "An equilibrium:"));
  host.appendChild(valueTable(orbit.equilibrium.map(function (value, k) {
    return [section.states[k] || "U(" + (k + 1) + ")", fullNumber(value)];
  })));
}

/** The returns of a torus do not follow each other: each begins at t = 0. Other orbits stay as they are. */
function withReturnsFromZero(orbit) {
  if (!orbit.segments.some(function (segment) { return segment.endsReturn; })) return orbit;
  let begin = 0;
  const segments = orbit.segments.map(function (segment) {
    const moved = Object.assign({}, segment, { t: segment.t.map(function (t) { return t - begin; }) });
    if (segment.endsReturn) begin = segment.t[segment.t.length - 1];
    return moved;
  });
  return Object.assign({}, orbit, { segments: segments, isTorus: true });
}

/** Choices that are kept from one orbit to the next. */
const orbitView = { x: 0, y: 1, shown: null };

function nameOfState(states, k) {
  return states[k] || "U(" + (k + 1) + ")";
}

function showOrbit(host, orbit, states) {
  const count = orbit.segments[0].u.length;
  if (orbitView.x >= count) orbitView.x = 0;
  if (orbitView.y >= count) orbitView.y = count > 1 ? 1 : 0;
  const returns = orbit.segments.filter(function (segment) { return segment.endsReturn; }).length;
  if (orbit.isTorus) host.appendChild(element("p", "", "A torus: " + returns + " returns, each from t = 0."));
  const ends = describeEnds(orbit);
  if (ends) host.appendChild(element("p", "ends", ends));
  if (count > 1) showPortrait(host, orbit, states, count);
  showSeries(host, orbit, states, count);
}

/** What ends a segment: an event; without one the phase condition. */
function endOf(segment) {
  return segment.event || "the phase condition";
}

/** How the segments end, in a sentence. */
function describeEnds(orbit) {
  const known = orbit.segments.filter(function (segment) { return segment.event || segment.jump; });
  if (!known.length || orbit.segments.length > 8) return "";
  return "Segments end in: " + orbit.segments.map(function (segment) {
    return segment.jumps ? endOf(segment) + " (" + (segment.jump || "a jump") + ")" : endOf(segment);
  }).join("; ") + ".";
}

function stateChoice(text, states, count, chosen, change) {
  const label = element("label", "", text + " ");
  const select = element("select");
  for (let k = 0; k < count; ++k) {
    const option = element("option", "", nameOfState(states, k));
    option.value = k;
    option.selected = k === chosen;
    select.appendChild(option);
  }
  select.addEventListener("change", function () { change(Number(select.value)); });
  label.appendChild(select);
  return label;
}

function showPortrait(host, orbit, states, count) {
  const choices = host.appendChild(element("div", "choices"));
  const place = host.appendChild(element("div", "portrait"));
  const draw = function () {
    place.textContent = "";
    drawPortrait(place, orbit, states);
  };
  choices.appendChild(element("span", "", "Phase portrait:"));
  choices.appendChild(stateChoice("x", states, count, orbitView.x, function (k) { orbitView.x = k; draw(); }));
  choices.appendChild(stateChoice("y", states, count, orbitView.y, function (k) { orbitView.y = k; draw(); }));
  draw();
}

function valuesOfState(orbit, k) {
  return d3.merge(orbit.segments.map(function (segment) { return segment.u[k]; }));
}

function drawPortrait(host, orbit, states) {
  const a = orbitView.x, b = orbitView.y;
  const plot = smallPlot(host, {
    height: 300, title: "Phase portrait: " + nameOfState(states, b) + " over " + nameOfState(states, a),
    x: { label: { t: nameOfState(states, a) }, range: paddedRange(valuesOfState(orbit, a), 0.06) },
    y: { label: { t: nameOfState(states, b) }, range: paddedRange(valuesOfState(orbit, b), 0.06) }
  });
  orbit.segments.forEach(function (segment) { drawLine(plot, segment.u[a], segment.u[b], lineClass(orbit)); });
  drawEnds(plot, orbit, function (segment, k) { return [segment.u[a][k], segment.u[b][k]]; });
  orbit.contacts.forEach(function (contact) {
    drawDot(plot, contact.u[a], contact.u[b], 5, "contact", contact.text + " at t = " + contact.t);
  });
}

/** The many lines of a torus are thin. */
function lineClass(orbit) {
  return orbit.isTorus ? "line thin" : "line";
}

/** Events as dots; jumps as dotted lines from a filled to an open one. `place` says where value k of a segment is. */
function drawEnds(plot, orbit, place) {
  orbit.segments.forEach(function (segment, s) {
    const isLast = s + 1 === orbit.segments.length;
    if (segment.endsReturn || (isLast && !orbit.closed)) return;
    const last = segment.t.length - 1, next = orbit.segments[(s + 1) % orbit.segments.length];
    const end = place(segment, last), start = place(next, 0);
    const title = endOf(segment) + " at t = " + shortNumber(segment.t[last], 7);
    if (segment.jumps) {
      drawLine(plot, [end[0], start[0]], [end[1], start[1]], "jump");
      drawDot(plot, start[0], start[1], 3.5, "event after", "after " + (segment.jump || "the jump"));
    }
    drawDot(plot, end[0], end[1], 3.5, "event before", title + (segment.jump ? ", " + segment.jump : ""));
  });
}

function showSeries(host, orbit, states, count) {
  const choices = host.appendChild(element("div", "choices"));
  const place = host.appendChild(element("div", "series"));
  if (!orbitView.shown) orbitView.shown = d3.range(Math.min(2, count));
  const shown = function () { return orbitView.shown.filter(function (k) { return k < count; }); };
  const draw = function () {
    place.textContent = "";
    shown().forEach(function (k, j) { drawSeries(place, orbit, states, k, j + 1 === shown().length); });
  };
  choices.appendChild(element("span", "", "Time series:"));
  d3.range(count).forEach(function (k) {
    const label = element("label"), box = element("input");
    box.type = "checkbox";
    box.checked = shown().indexOf(k) >= 0;
    box.addEventListener("change", function () {
      orbitView.shown = d3.range(Math.max(count, d3.max(orbitView.shown) + 1 || 0)).filter(function (j) {
        return j === k ? box.checked : orbitView.shown.indexOf(j) >= 0;
      });
      draw();
    });
    label.appendChild(box);
    label.appendChild(element("span", "", nameOfState(states, k)));
    choices.appendChild(label);
  });
  draw();
}

function drawSeries(host, orbit, states, k, isLast) {
  const name = nameOfState(states, k), segments = orbit.segments;
  const times = [segments[0].t[0], d3.max(segments, function (s) { return s.t[s.t.length - 1]; })];
  const plot = smallPlot(host, {
    height: isLast ? 172 : 140, title: "Time series of " + name, hasNumbersBelow: isLast,
    x: { label: { t: "t" }, range: paddedRange(times, 0.02) },
    y: { label: { t: name }, range: paddedRange(valuesOfState(orbit, k), 0.08) }
  });
  segments.forEach(function (segment, s) {
    drawLine(plot, segment.t, segment.u[k], lineClass(orbit));
    const last = segment.t.length - 1, next = segments[s + 1] || (orbit.closed ? segments[0] : null);
    if (!next || segment.endsReturn) return;
    const t = segment.t[last];
    if (segment.jumps) {
      drawLine(plot, [t, t], [segment.u[k][last], next.u[k][0]], "jump");
      drawDot(plot, t, next.u[k][0], 3.5, "event after", "after " + (segment.jump || "the jump"));
    }
    drawDot(plot, t, segment.u[k][last], 3.5, "event before", endOf(segment) + " at t = " + shortNumber(t, 7));
  });
  orbit.contacts.forEach(function (contact) {
    drawDot(plot, contact.t, contact.u[k], 5, "contact", contact.text + " at t = " + contact.t);
  });
}

// Multipliers ---------------------------------------------------------------------------------------------------------

const farthest = 2.5;  // of multipliers in the picture

function nounOfSpectrum(section) {
  return section.spectrum === "eigenvalues" ? "Eigenvalues" : "Multipliers";
}

function showMultipliers(host, facts) {
  const flat = facts.section.multipliers[facts.row];
  const isMap = facts.section.spectrum === "multipliers";
  if (!facts.section.spectrum) return;
  host.appendChild(element("h3", "", nounOfSpectrum(facts.section)));
  if (!flat) {
    addWarning(host, nounOfSpectrum(facts.section) + " are not available" +
                     (facts.branch.noMultipliers ? ": " + facts.branch.noMultipliers : " at this point") + ".");
    return;
  }
  const list = [];
  for (let k = 0; k < flat.length; k += 2) list.push({ re: flat[k], im: flat[k + 1] });
  drawMultipliers(host, list, isMap);
  host.appendChild(multiplierTable(list, isMap));
}

function modulus(mu) {
  return mu.re === null || mu.im === null ? Infinity : Math.sqrt(mu.re * mu.re + mu.im * mu.im);
}

function drawMultipliers(host, list, isMap) {
  const sizes = list.map(modulus).filter(isFinite);
  const near = sizes.filter(function (size) { return !isMap || size <= farthest; });
  const size = 1.15 * Math.max(isMap ? 1 : 1e-6, d3.max(near) || 0);
  const range = [-size, size];
  const plot = smallPlot(host, {
    height: 330, isEqual: true, title: isMap ? "Multipliers and the unit circle" : "Eigenvalues",
    x: { label: { t: "real part" }, range: range }, y: { label: { t: "imaginary part" }, range: range }
  });
  drawLine(plot, plot.x.domain(), [0, 0], "zero");
  drawLine(plot, [0, 0], plot.y.domain(), "zero");
  if (isMap) {
    const radius = Math.abs(plot.x(1) - plot.x(0));
    drawDot(plot, 0, 0, radius, "circle");
  }
  let far = 0;
  list.forEach(function (mu, k) {
    if (!isFinite(modulus(mu)) || (isMap && modulus(mu) > farthest)) { ++far; return; }
    const isOutside = isMap ? modulus(mu) > 1 + 1e-4 : mu.re > 1e-6;
    drawDot(plot, mu.re, mu.im, 4.5, isOutside ? "multiplier outside" : "multiplier", "number " + (k + 1));
  });
  if (far)
    host.appendChild(element("p", "", far + (far === 1 ? " multiplier is" : " multipliers are") +
                                      " too far outside for the picture."));
}

function multiplierTable(list, isMap) {
  const table = element("table", "values multipliers");
  const head = table.insertRow();
  ["", "real", "imaginary"].concat(isMap ? ["modulus"] : []).forEach(function (text) {
    head.appendChild(element("th", "", text));
  });
  list.forEach(function (mu, k) {
    const line = table.insertRow();
    const size = isFinite(modulus(mu)) ? shortNumber(modulus(mu), 7) : "\u221e";
    [String(k + 1), fullNumber(mu.re), fullNumber(mu.im)].concat(isMap ? [size] : []).forEach(function (text) {
      const cell = line.insertCell();
      cell.className = "number";
      cell.textContent = text;
    });
  });
  const host = element("div", "scroll");
  host.appendChild(table);
  return host;
}

// Restart -------------------------------------------------------------------------------------------------------------

function showRestart(host, facts) {
  const source = facts.label && facts.label.restarts ? facts.label : facts.source && facts.source.label;
  host.appendChild(element("h3", "", "Restart"));
  if (!source || !source.restarts) {
    addWarning(host, facts.section.restartRemark || "Nothing to restart from: this branch has no stored orbit.");
    return;
  }
  const name = source.name || String(source.label), parts = facts.branch.restart;
  const where = facts.label === source ? "from this point" : "from label " + source.label + " (" + name + ")";
  host.appendChild(element("p", "", "Continue " + where + ":"));
  addCommand(host, "restart", parts[0] + name + parts[1] + name);
  if (source.birth) {
    host.appendChild(element("p", "", "Switch to the branch that is born there:"));
    addCommand(host, "switch", parts[0] + name + "_born" + parts[1] + name + source.birth);
  }
  if (facts.section.restartRemark) addWarning(host, facts.section.restartRemark);
}

function addCommand(host, id, text) {
  const pre = element("pre");
  const code = pre.appendChild(element("code", "", text));
  code.id = id;
  host.appendChild(pre);
  const copying = button("Copy", function () { copyText(code, copying); });
  copying.setAttribute("aria-label", "Copy the command");
  host.appendChild(copying);
}

/** To the clipboard; where the browser refuses, the text is selected. */
function copyText(node, copying) {
  const done = function () {
    copying.textContent = "Copied";
    setTimeout(function () { copying.textContent = "Copy"; }, 1500);
  };
  const select = function () {
    const range = document.createRange();
    range.selectNodeContents(node);
    const selection = window.getSelection();
    selection.removeAllRanges();
    selection.addRange(range);
    if (document.execCommand("copy")) done();
  };
  if (navigator.clipboard && navigator.clipboard.writeText)
    navigator.clipboard.writeText(node.textContent).then(done, select);
  else select();
}
