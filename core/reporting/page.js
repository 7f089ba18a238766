// Draws what the element "data" holds:
//   bucket, buckets, end   time axis: bucket k is [k, k + 1) · bucket seconds
//   charts                 [{id, title, unit, note, series: [{label, color, dashed, values}]}]
//                          with two values a bucket, at its first and third quarter
//   modes, limits          of each side: [first bucket, last bucket, mode or limit bits] …
//   faults                 [{t, side, name}]
//   histograms             [{title, unit, p50, p99, edges: [low, high, bins], series: [{label, counts}]}]
(function () {
  'use strict';
  const data = JSON.parse(document.getElementById('data').textContent);
  const modeNames = ['idle', 'engaging', 'engaged', 'holding', 'faulted'];
  const gravity = [1, 2, 0, 3, 4];
  const sides = Object.keys(data.modes);
  const gutter = 52;
  const graphs = [];
  const readout = document.getElementById('readout');
  const hint = readout.textContent;
  let linking = false;

  const color = name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
  const startOf = bucket => bucket * data.bucket;

  function element(parent, tag, className, text) {
    const child = document.createElement(tag);
    if (className) child.className = className;
    if (text) child.textContent = text;
    parent.appendChild(child);
    return child;
  }

  function time(t) {
    const span = graphs.length ? graphs[0].xAxisRange()[1] - graphs[0].xAxisRange()[0] : data.end;
    return t.toFixed(span < 0.05 ? 5 : span < 0.5 ? 4 : span < 50 ? 3 : 2) + ' s';
  }

  function value(v) {
    if (v === null || v === undefined || isNaN(v)) return '–';
    const size = Math.abs(v);
    return v.toFixed(size >= 1000 ? 0 : size >= 100 ? 1 : size >= 1 ? 2 : 3);
  }

  // ---- modes, limits and faults ------------------------------------------------------------------

  // Stretches of the graver of both sides' modes, shaded behind every chart.
  const shades = (function () {
    const worst = new Array(data.buckets).fill(-1);
    for (const side of sides) {
      for (const [first, last, mode] of data.modes[side]) {
        for (let k = first; k <= last; ++k) {
          if (worst[k] < 0 || gravity[mode] > gravity[worst[k]]) worst[k] = mode;
        }
      }
    }
    const runs = [];
    for (let k = 0; k < worst.length; ++k) {
      const run = runs[runs.length - 1];
      if (run && run[2] === worst[k]) run[1] = k; else runs.push([k, k, worst[k]]);
    }
    return runs.filter(run => run[2] >= 0 && run[2] !== 2);
  })();

  function band(context, area, graph, run, top, height) {
    const left = Math.max(graph.toDomXCoord(startOf(run[0])), area.x);
    const right = Math.min(graph.toDomXCoord(startOf(run[1] + 1)), area.x + area.w);
    if (right > left) context.fillRect(left, top, Math.max(right - left, 1), height);
  }

  function faultLines(context, area, graph) {
    context.strokeStyle = color('fault-line');
    context.lineWidth = 1.5;
    for (const fault of data.faults) {
      const x = graph.toDomXCoord(fault.t);
      if (x < area.x || x > area.x + area.w) continue;
      context.beginPath();
      context.moveTo(x, area.y);
      context.lineTo(x, area.y + area.h);
      context.stroke();
    }
  }

  function shade(context, area, graph) {
    for (const run of shades) {
      context.fillStyle = color(modeNames[run[2]]);
      band(context, area, graph, run, area.y, area.h);
    }
    faultLines(context, area, graph);
  }

  // The strip: a row a side with its modes, and below it a mark wherever a limit was on.
  function drawStrip(context, area, graph) {
    const row = area.h / sides.length;
    sides.forEach((side, i) => {
      const top = area.y + i * row + 3;
      const height = row - 12;
      for (const run of data.modes[side]) {
        context.fillStyle = color(modeNames[run[2]]);
        band(context, area, graph, run, top, height);
      }
      context.fillStyle = color('troubled');
      for (const run of data.limits[side]) band(context, area, graph, run, top + height + 1, 4);
    });
    faultLines(context, area, graph);
  }

  function runAt(runs, t) {
    const bucket = Math.floor(t / data.bucket);
    return runs.find(run => run[0] <= bucket && bucket <= run[1]);
  }

  function describe(t) {
    const parts = sides.map(side => {
      const mode = runAt(data.modes[side], t);
      const limit = runAt(data.limits[side], t);
      const names = limit ? data.limitNames.filter((_, bit) => (limit[2] >> bit) & 1) : [];
      const text = mode ? modeNames[mode[2]] : 'not running';
      return side + ' ' + text + (names.length ? ' (' + names.join(', ').replace(/_/g, ' ') + ')' : '');
    });
    const near = data.faults.find(fault => Math.abs(fault.t - t) <= 2 * data.bucket);
    if (near) parts.push('fault of the ' + near.side + ': ' + near.name.replace(/_/g, ' '));
    return time(t) + ': ' + parts.join(', ');
  }

  // ---- charts ------------------------------------------------------------------------------------

  function rowsOf(series) {
    const rows = [];
    for (let i = 0; i < 2 * data.buckets; ++i) {
      rows.push([(i / 2 + 0.25) * data.bucket].concat(series.map(one => one.values[i])));
    }
    return rows;
  }

  // One finger scrolls the page, two zoom the chart.
  const interaction = Object.assign({}, Dygraph.defaultInteractionModel, {
    touchstart: (event, graph, context) => {
      if (event.touches.length > 1) Dygraph.defaultInteractionModel.touchstart(event, graph, context);
    },
    mousewheel: undefined,
  });

  function link(graph) {
    if (linking) return;
    linking = true;
    const range = graph.xAxisRange();
    for (const other of graphs) if (other !== graph) other.updateOptions({dateWindow: range});
    linking = false;
  }

  function select(graph, row, t) {
    for (const other of graphs) if (other !== graph) other.setSelection(row);
    readout.textContent = describe(t);
  }

  function unselect() {
    readout.textContent = hint;
    for (const graph of graphs) graph.clearSelection();
  }

  function colorsOf(series) {
    return series.map(one => color(one.color));
  }

  function commonOptions(interactive) {
    return {
      xRangePad: 0, strokeWidth: 1.3, highlightCircleSize: 3, animatedZooms: false,
      axisLabelFontSize: 12, axisLineColor: color('rule'), gridLineColor: color('grid'),
      interactionModel: interactive, dateWindow: [0, data.end],
      axes: {
        x: {valueFormatter: time, axisLabelFormatter: t => +t.toFixed(6) + ' s', pixelsPerLabel: 90},
        y: {axisLabelWidth: gutter, pixelsPerLabel: 26, axisLabelFormatter: v => String(+v.toPrecision(6))},
      },
      drawCallback: (graph, first) => { if (!first) link(graph); },
      highlightCallback: function (event, t, points, row) { select(this, row, t); },
      unhighlightCallback: unselect,
    };
  }

  function legend(chart) {
    // A series without a value under the pointer is no hidden one: state.isVisible says less.
    return state => state.series.map((one, i) => {
      const visible = state.dygraph.visibility()[i];
      const line = '<i class="line' + (chart.series[i].dashed ? ' dashed' : '') + '" style="border-color:' + one.color + '"></i>';
      const shown = state.x === undefined ? '' : '<b>' + (visible ? one.yHTML || '–' : '') + '</b>';
      return '<span class="key' + (visible ? '' : ' hidden') + '" data-series="' + i + '">' + line + one.labelHTML + shown + '</span>';
    }).join('');
  }

  function addChart(chart) {
    const box = element(document.getElementById('charts'), 'div', 'chart');
    box.id = chart.id;
    const head = element(box, 'div', 'head');
    element(head, 'h3', '', chart.title + ' (' + chart.unit + ')');
    element(head, 'p', 'note', chart.note);
    const names = element(box, 'div', 'keys legend');
    const plot = element(box, 'div', 'plot');
    if (!chart.series.length) {
      plot.remove();
      names.textContent = 'Not measured in this run.';
      return;
    }
    const options = commonOptions(interaction);
    const series = {};
    for (const one of chart.series) if (one.dashed) series[one.label] = {strokePattern: [6, 4]};
    options.axes.y.valueFormatter = value;
    const graph = new Dygraph(plot, rowsOf(chart.series), Object.assign(options, {
      labels: ['t'].concat(chart.series.map(one => one.label)),
      colors: colorsOf(chart.series), series: series, legend: 'always', labelsDiv: names,
      legendFormatter: legend(chart), underlayCallback: shade,
    }));
    graph.chart = chart;
    names.addEventListener('click', event => {
      const key = event.target.closest('.key');
      if (!key) return;
      const i = Number(key.dataset.series);
      graph.setVisibility(i, !graph.visibility()[i]);
    });
    graphs.push(graph);
  }

  function addStrip() {
    document.getElementById('strip').style.height = (12 + 36 * sides.length) + 'px';
    const center = i => sides.length - i - 0.5;
    const options = commonOptions(interaction);
    options.axes.y = {
      axisLabelWidth: gutter, drawGrid: false, valueRange: [0, sides.length],
      ticker: () => sides.map((side, i) => ({v: center(i), label: side})),
    };
    options.axes.x.drawAxis = false;
    options.axes.x.drawGrid = false;
    const rows = [];
    for (let i = 0; i < 2 * data.buckets; ++i) rows.push([(i / 2 + 0.25) * data.bucket].concat(sides.map((_, k) => center(k))));
    const graph = new Dygraph(document.getElementById('strip'), rows, Object.assign(options, {
      labels: ['t'].concat(sides), legend: 'never', strokeWidth: 0, highlightCircleSize: 0,
      colors: sides.map(() => 'transparent'), underlayCallback: drawStrip,
    }));
    graphs.push(graph);
  }

  function zoom(how) {
    const [from, to] = graphs[0].xAxisRange();
    const span = to - from;
    const change = {in: [0.25, -0.25], out: [-0.5, 0.5], back: [-0.5, -0.5], forth: [0.5, 0.5]}[how];
    let range = change ? [from + change[0] * span, to + change[1] * span] : [0, data.end];
    const shift = Math.max(0, -range[0]) - Math.max(0, range[1] - data.end);
    range = [Math.max(0, range[0] + shift), Math.min(data.end, range[1] + shift)];
    graphs[0].updateOptions({dateWindow: range});
  }

  // ---- histograms --------------------------------------------------------------------------------

  function ticksOf(low, high) {
    const ticks = [];
    const decades = Math.log10(high / low);
    for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e) {
      for (const step of decades > 2.2 ? [1] : [1, 2, 5]) {
        const tick = step * Math.pow(10, e);
        if (tick >= low * 0.999 && tick <= high * 1.001) ticks.push(tick);
      }
    }
    return ticks;
  }

  function addHistogram(histogram) {
    const box = element(document.getElementById('histograms'), 'div');
    element(box, 'h3', '', histogram.title + ' (' + histogram.unit + ')');
    const names = element(box, 'div', 'keys');
    if (!histogram.series.length) {
      names.textContent = 'Not measured in this run.';
      return;
    }
    const [low, high, bins] = histogram.edges;
    const width = 360, height = 190, left = 34, bottom = 22, top = 18, right = 18;
    const most = Math.max(...histogram.series.map(one => Math.max(...one.counts)));
    const decades = Math.max(1, Math.ceil(Math.log10(most + 1)));
    const x = t => left + (width - left - right) * Math.log(Math.max(t, low) / low) / Math.log(high / low);
    const y = n => height - bottom - (height - bottom - top) * (n > 0 ? (Math.log10(n) + 0.25) / (decades + 0.25) : 0);
    let svg = '<svg viewBox="0 0 ' + width + ' ' + height + '" role="img">';
    for (let e = 0; e <= decades; ++e) {
      const at = y(Math.pow(10, e));
      svg += '<line class="grid" x1="' + left + '" x2="' + (width - right) + '" y1="' + at + '" y2="' + at + '"/>' +
        '<text text-anchor="end" x="' + (left - 5) + '" y="' + (at + 4) + '">' + (e < 4 ? Math.pow(10, e) : '1e' + e) + '</text>';
    }
    for (const tick of ticksOf(low, high)) {
      svg += '<text text-anchor="middle" x="' + x(tick) + '" y="' + (height - 6) + '">' + (+tick.toPrecision(3)) + '</text>';
    }
    for (const one of histogram.series) {
      const shade = color(one.label);
      const edge = k => (left + (width - left - right) * k / bins).toFixed(1);
      let path = '';
      one.counts.forEach((n, k) => {
        const before = one.counts[k - 1] > 0, after = one.counts[k + 1] > 0;
        if (n > 0) path += (before ? '' : 'M' + edge(k) + ',' + y(0)) + 'V' + y(n).toFixed(1) + 'H' + edge(k + 1) + (after ? '' : 'V' + y(0));
      });
      svg += '<path class="bars" fill="' + shade + '" stroke="' + shade + '" d="' + path + '"/>';
      const key = element(names, 'span', 'key');
      element(key, 'i', 'line').style.borderColor = shade;
      key.append(one.label);
    }
    for (const [share, at, anchor] of [['50 %', histogram.p50, 'end'], ['99 %', histogram.p99, 'start']]) {
      svg += '<line class="share" x1="' + x(at) + '" x2="' + x(at) + '" y1="' + top + '" y2="' + y(0) + '"/>' +
        '<text text-anchor="' + anchor + '" x="' + x(at) + '" y="' + (top - 6) + '">' + share + '</text>';
    }
    svg += '<line class="axis" x1="' + left + '" x2="' + (width - right) + '" y1="' + y(0) + '" y2="' + y(0) + '"/></svg>';
    element(box, 'div').innerHTML = svg;
  }

  // ---- put together ------------------------------------------------------------------------------

  function addModeKey() {
    const keys = document.getElementById('mode-key');
    keys.replaceChildren();
    const used = new Set(sides.flatMap(side => data.modes[side].map(run => run[2])));
    modeNames.forEach((name, mode) => {
      if (!used.has(mode)) return;
      const key = element(keys, 'span', 'key');
      element(key, 'i', 'patch').style.background = color(name);
      key.append(name);
    });
    if (sides.some(side => data.limits[side].length)) {
      const key = element(keys, 'span', 'key');
      element(key, 'i', 'line').style.borderColor = color('troubled');
      key.append('limit on');
    }
    if (data.faults.length) {
      const key = element(keys, 'span', 'key');
      element(key, 'i', 'line').style.borderColor = color('fault-line');
      key.append('fault');
    }
  }

  function drawHistograms() {
    document.getElementById('histograms').replaceChildren();
    data.histograms.forEach(addHistogram);
  }

  addModeKey();
  addStrip();
  data.charts.forEach(addChart);
  drawHistograms();
  document.querySelector('.tools').addEventListener('click', event => {
    const button = event.target.closest('button');
    if (button) zoom(button.dataset.zoom);
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
    addModeKey();
    drawHistograms();
    for (const graph of graphs) {
      const options = {axisLineColor: color('rule'), gridLineColor: color('grid')};
      if (graph.chart) options.colors = colorsOf(graph.chart.series);
      graph.updateOptions(options);
    }
  });
})();
