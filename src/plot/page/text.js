// Texts: labels with subscripts, and numbers.

/** The pieces of a label {t, m}: texts with "sub" or "super" or "" for their place. Markup is gnuplot's. */
function piecesOf(label) {
  if (!label.m) return label.t ? [{ text: label.t, place: "" }] : [];
  const pieces = [];
  let place = "", grouped = false;
  const add = function (c) {
    const last = pieces[pieces.length - 1];
    if (last && last.place === place) last.text += c;
    else pieces.push({ text: c, place: place });
    if (!grouped) place = "";
  };
  const characters = Array.from(label.t);
  for (let k = 0; k < characters.length; ++k) {
    const c = characters[k];
    if (c === "\\") add(characters[++k] || "");
    else if (c === "_" || c === "^") place = c === "_" ? "sub" : "super";
    else if (c === "{") grouped = true;
    else if (c === "}") { grouped = false; place = ""; }
    else add(c);
  }
  return pieces;
}

/** The label without its markup. */
function plainLabel(label) {
  return piecesOf(label).map(function (piece) { return piece.text; }).join("");
}

/** Fills an SVG text element. */
function setSvgLabel(element, label) {
  const text = d3.select(element);
  text.text(null);
  let raised = 0;
  piecesOf(label).forEach(function (piece) {
    const shift = piece.place === "sub" ? 0.25 : piece.place === "super" ? -0.4 : 0;
    text.append("tspan").attr("dy", (shift - raised) + "em").style("font-size", piece.place ? "80%" : null)
        .text(piece.text);
    raised = shift * (piece.place ? 0.8 : 1);
  });
}

/** Appends the label to an HTML element. */
function appendLabel(element, label) {
  piecesOf(label).forEach(function (piece) {
    const node = piece.place ? document.createElement(piece.place === "sub" ? "sub" : "sup")
                             : document.createElement("span");
    node.textContent = piece.text;
    element.appendChild(node);
  });
}

/** A number with all the digits that the files have; infinity for what they cannot hold. */
function fullNumber(value) {
  return value === null || value === undefined ? "\u221e" : String(value).replace(/-/g, "\u2212");
}

/** To about `digits` significant digits. */
function shortNumber(value, digits) {
  if (value === null) return "\u221e";
  return String(Number(value.toPrecision(digits))).replace(/-/g, "\u2212");
}

/** Numbers at tics that are `step` apart. */
function ticNumber(value, step) {
  const size = Math.abs(value);
  if (size < step * 1e-6) return "0";
  if (size >= 1e6 || size < 1e-4) {
    const digits = Math.max(0, Math.floor(Math.log10(size)) - Math.floor(Math.log10(step) + 1e-9));
    return value.toExponential(Math.min(digits, 15)).replace("e+", "e").replace(/-/g, "\u2212");
  }
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return value.toFixed(Math.min(decimals, 15)).replace("-", "\u2212");
}

/** Tics of a scale of D3 and the text of each. */
function ticsOf(scale, isLogarithmic, count) {
  const domain = scale.domain();
  const decades = isLogarithmic ? Math.log10(domain[1] / domain[0]) : 0;
  if (decades >= 1.5) {
    const every = Math.max(1, Math.ceil(decades / count));
    const values = [];
    for (let p = Math.ceil(Math.log10(domain[0]) - 1e-9); p <= Math.log10(domain[1]) + 1e-9; p += every)
      values.push(Math.pow(10, p));
    return { values: values, text: function (v) { return ticNumber(v, v); } };
  }
  const linear = d3.scale.linear().domain(domain);
  const values = linear.ticks(count);
  const step = values.length > 1 ? values[1] - values[0] : Math.abs(domain[1] - domain[0]);
  return { values: values, text: function (v) { return ticNumber(v, step); } };
}

function element(tag, className, text) {
  const node = document.createElement(tag);
  if (className) node.className = className;
  if (text !== undefined) node.textContent = text;
  return node;
}

function button(text, action) {
  const node = element("button", "", text);
  node.type = "button";
  node.addEventListener("click", action);
  return node;
}

/** A table of two columns: names and values, which are texts or labels. */
function valueTable(rows, className) {
  const table = element("table", className || "values");
  rows.forEach(function (row) {
    const line = table.insertRow();
    const name = line.insertCell();
    if (typeof row[0] === "string") name.textContent = row[0];
    else appendLabel(name, row[0]);
    const value = line.insertCell();
    value.className = "number";
    value.textContent = row[1];
    if (String(row[1]).length > 28) value.className = "";
  });
  return table;
}
