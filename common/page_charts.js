/* What pages are built of: numbers in the units that people use, tables, curves (dygraphs) and maps (page_maps.js). Nothing
 * of a file becomes markup: all of it is set as text. */
const tosui = (function () {
  'use strict';
  const data = JSON.parse(document.getElementById('data').textContent);
  const by = id => document.getElementById(id);
  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  /* Okabe, Ito (2008); on dark paper the light ones first. */
  const colour = i => css('--c' + i % 7);
  /* What is drawn when all has its place, and anew when paper or width change. */
  const painters = [];
  let placed = false;
  const draw = f => {
    painters.push(f);
    if (placed) f();
  };
  const again = () => painters.forEach(f => f());
  const add = (parent, tag, attributes, ...content) => {
    const e = document.createElement(tag);
    Object.entries(attributes || {}).forEach(([name, value]) => e.setAttribute(name, value));
    e.append(...content.filter(c => c !== undefined && c !== null));
    if (parent) parent.append(e);
    return e;
  };
  const known = v => typeof v === 'number' && Number.isFinite(v);

  /* ---- numbers: three digits, units that people use ---- */
  const exponent = n => String(n).replace('-', '\u2212').replace(/\d/g, d => '⁰¹²³⁴⁵⁶⁷⁸⁹'[d]).replace('\u2212', '⁻');
  const power = v => (v === 0 ? 0 : Math.floor(Math.log10(Math.abs(v)) + 1e-12));
  const plain = p => p >= -3 && p < 6;
  const number = (v, digits = 3) => {
    if (!known(v)) return '';
    const p = power(Number(v.toPrecision(digits)));
    if (plain(p)) return v.toFixed(Math.min(Math.max(digits - 1 - p, 0), 12)).replace(/^-(0(\.0+)?)$/, '$1');
    return number(v / Math.pow(10, p), digits) + ' × 10' + exponent(p);
  };
  const short = v => {
    if (!known(v)) return '';
    const n = Number(v.toPrecision(4)), p = power(n);
    return plain(p) ? String(n) : n.toExponential().replace('e+', 'e');
  };
  const percent = share => number(100 * share, Math.abs(share) < 0.1 ? 2 : 3).replace(/(\.\d*?)0+$/, '$1').replace(/\.$/, '') + ' %';
  /* Values with one power of ten and the decimals that the second digit of an error needs, four digits at most. */
  function scaled(values, error) {
    const p = power(Math.max(...values.map(Math.abs)));
    const scale = plain(p) ? 1 : Math.pow(10, p);
    const first = plain(p) ? p : 0, decimals = Math.max(error > 0 ? Math.min(1 - power(error / scale), 3 - first) : 2 - first, 0);
    const round = v => (first > 3 && !(error > 0) ? Number(v.toPrecision(4)) : v / scale).toFixed(decimals);
    return {texts: values.map(round), ten: plain(p) ? '' : ' × 10' + exponent(p), decimals: decimals, scale: scale};
  }
  /* "0.154 ± 0.002 cm/s" */
  function quantity(value, error, unit) {
    if (!known(value)) return '';
    if (!(error > 1e-6 * Math.abs(value))) return number(value) + ' ' + unit;
    const s = scaled([value], error), half = (error / s.scale).toFixed(s.decimals);
    if (!(half > 0)) return s.texts[0] + s.ten + ' ' + unit;
    return s.ten ? `(${s.texts[0]} ± ${half})${s.ten} ${unit}` : `${s.texts[0]} ± ${half} ${unit}`;
  }
  /* ["0.0301 cm/s", "0.027 to 0.033 (95 %)"] */
  function interval(value, low, high, unit) {
    if (value === 0 && !(high > low)) return ['0 ' + unit, ''];
    const open = !(known(low) && known(high) && high > low), s = scaled(open ? [value] : [value, low, high], open ? 0 : (high - low) / 2);
    return [s.texts[0] + s.ten + ' ' + unit, open || s.texts[1] === s.texts[2] ? '' : `${s.texts[1]} to ${s.texts[2]}${s.ten} (95 %)`];
  }
  function size(metres, digits = 3) {
    const [scale, unit] = Math.abs(metres) < 0.9995e-3 ? [1e6, 'µm'] : Math.abs(metres) < 0.9995 ? [1e3, 'mm'] : [1, 'm'];
    return number(scale * metres, digits) + ' ' + unit;
  }
  function duration(seconds) {
    const [scale, unit] = seconds >= 172800 ? [86400, 'd'] : seconds >= 7200 ? [3600, 'h'] : seconds >= 120 ? [60, 'min'] :
      seconds >= 0.1 || seconds === 0 ? [1, 's'] : [1e-3, 'ms'];
    return Number((seconds / scale).toPrecision(3)) + ' ' + unit;
  }
  const unitOf = (high, units) => units.find(([factor]) => factor * high >= 0.1 && factor * high < 1000) || units[units.length - 1];
  const speedUnit = high => unitOf(high, [[1, 'm/s'], [100, 'cm/s'], [1e3, 'mm/s'], [1e6, 'µm/s'], [1e9, 'nm/s']]);
  const pressureUnit = high => unitOf(high, [[1e-3, 'kPa'], [1, 'Pa'], [1e3, 'mPa'], [1e6, 'µPa']]);

  /* ---- building blocks ---- */
  function table(parent, rows, caption, head) {
    rows = rows.filter(r => r && r[1] !== '' && r[1] !== undefined && r[1] !== null && r[1] !== false);
    if (rows.length === 0) return null;
    const t = add(parent, 'table', {class: 'facts'});
    if (caption) add(t, 'caption', {}, caption);
    if (head) add(add(t, 'thead'), 'tr', {}, ...head.map(h => add(null, 'th', {}, h)));
    const body = add(t, 'tbody');
    rows.forEach(r => add(body, 'tr', {}, add(null, 'th', {scope: 'row'}, r[0]), ...r.slice(1).map(c => add(null, 'td', {}, c))));
    return t;
  }
  const note = (parent, text) => text && add(parent, 'p', {class: 'note'}, text);
  const save = (name, href) => add(null, 'a', {download: name, href: href}).click();
  function tools(parent, ...buttons) {
    const box = add(parent, 'div', {class: 'tools'});
    buttons.forEach(([text, action]) => add(box, 'button', {type: 'button'}, text).addEventListener('click', action));
    return box;
  }

  /* A chart. series: {name, points: [[x, y], ...] (y null: a gap), dots, bars, step, dash, colour, low, high (with points)};
   * options: those of dygraphs, and lines: [{x or y, name, colour}]. */
  function chart(parent, title, xlabel, ylabel, series, options = {}) {
    series = series.filter(s => s && s.points.some(p => known(p[1])));
    if (series.length === 0 || !parent) return;
    const box = add(parent, 'div', {class: 'chart'});
    add(box, 'h3', {}, title);
    const plot = add(box, 'div', {class: 'plot', role: 'img', 'aria-label': `${title}: ${ylabel} against ${xlabel}`});
    const legend = add(box, 'div', {class: 'legend'}), lines = options.lines || [], names = new Set([xlabel]);
    series.forEach(s => {
      while (names.has(s.name)) s.name += '\u2032';
      names.add(s.name);
    });
    const rows = [];
    series.flatMap((s, i) => s.points.map(p => [p[0], i, p[1]])).sort((a, b) => a[0] - b[0]).forEach(([x, i, y]) => {
      let row = rows[rows.length - 1];
      if (!row || row[0] !== x || row[i + 1] !== null) rows.push(row = [x, ...series.map(() => null)]);
      row[i + 1] = y === null ? NaN : y;
    });
    const shade = (s, i) => (s.colour === undefined ? colour(i) : typeof s.colour === 'number' ? colour(s.colour) : css(s.colour));
    const show = (x, row) => {
      legend.textContent = x === undefined ? '' : xlabel.replace(/ \(.*/, '') + ' ' + short(x) + '  ';
      series.forEach((s, i) => {
        const item = add(legend, 'span', {class: 'item'}), mark = add(item, 'i', {class: s.dots ? 'dots' : ''});
        mark.style[s.dots ? 'background' : 'borderTopColor'] = shade(s, i);
        if (s.dash) mark.style.borderTopStyle = 'dashed';
        item.append(s.name + (row && known(row[i + 1]) ? ': ' + short(row[i + 1]) : ''));
      });
    };
    const under = (context, area, g) => {
      context.save();
      context.font = '12px system-ui, sans-serif';
      const across = x => area.x + area.w * g.toPercentXCoord(x); /* of a logarithmic axis, too */
      lines.forEach((line, n) => {
        context.strokeStyle = context.fillStyle = css(line.colour || '--soft');
        context.setLineDash([6, 4]);
        context.beginPath();
        if (known(line.x)) {
          const x = across(line.x), right = n > 0 && x < area.x + 0.6 * area.w;
          context.moveTo(x, area.y);
          context.lineTo(x, area.y + area.h);
          context.textAlign = right ? 'left' : 'right';
          context.fillText(line.name, x + (right ? 4 : -4), area.y + 12 + 14 * (n % 4));
        } else {
          const y = g.toDomYCoord(line.y);
          context.moveTo(area.x, y);
          context.lineTo(area.x + area.w, y);
          context.textAlign = 'right';
          context.fillText(line.name, area.x + area.w - 4, y - 4);
        }
        context.stroke();
      });
      context.setLineDash([]);
      series.forEach((s, i) => s.low && s.points.forEach((p, k) => { /* intervals */
        if (!known(s.low[k]) || !known(s.high[k])) return;
        const x = across(p[0]), [a, b] = [s.low[k], s.high[k]].map(y => g.toDomYCoord(y));
        context.strokeStyle = shade(s, i);
        context.lineWidth = 2;
        context.beginPath();
        context.moveTo(x, a);
        context.lineTo(x, b);
        [a, b].forEach(y => {
          context.moveTo(x - 4, y);
          context.lineTo(x + 4, y);
        });
        context.stroke();
      }));
      context.restore();
    };
    const barPlotter = e => {
      const c = e.drawingContext, base = e.dygraph.toDomYCoord(0);
      const wide = 0.8 * Math.min(40, e.points.length > 1 ? e.points[1].canvasx - e.points[0].canvasx : 40);
      c.fillStyle = e.color;
      e.points.forEach(p => c.fillRect(p.canvasx - wide / 2, p.canvasy, wide, base - p.canvasy));
    };
    if (!window.Dygraph) return void note(plot, 'No curve: the program was built without dygraphs.');
    let graph = null;
    const axis = {axisLabelFormatter: v => short(v)};
    /* The axis of values that are equal but for rounding shows 0: its ticks would be equal. */
    const values = rows.flatMap(r => r.slice(1)).filter(known), most = Math.max(...values), least = Math.min(...values);
    const flat = most - least < 1e-3 * Math.max(Math.abs(most), Math.abs(least));
    draw(() => {
      const per = {};
      series.forEach((s, i) => {
        per[s.name] = {color: shade(s, i), strokeWidth: s.dots && !s.joined ? 0 : 2, drawPoints: !!s.dots, pointSize: s.dots ? 4 : 1,
                       highlightCircleSize: s.dots ? 6 : 3,
                       stepPlot: !!s.step, strokePattern: s.dash || null, ...(s.bars ? {plotter: barPlotter} : {})};
      });
      /* Only a canvas that has been on the screen gets to paper. */
      const all = rows.map(r => r[0]), padded = options.logx ? {xRangePad: 0, dateWindow: [0.85 * Math.min(...all), Math.max(...all) / 0.85]} : {};
      const look = {series: per, gridLineColor: css('--line'), axisLineColor: css('--soft')};
      if (graph) {
        graph.updateOptions(look);
        graph.resize();
      } else {
        graph = new Dygraph(plot, rows, {
          labels: [xlabel, ...series.map(s => s.name)], connectSeparatedPoints: true, xlabel: xlabel, ylabel: ylabel, legend: 'never',
          axisLabelWidth: 62, xRangePad: 8, yRangePad: 12, labelsKMB: false, axes: {y: axis, x: {...axis, ...(options.logx ? {logscale: true} : {})}},
          underlayCallback: under, highlightCallback: (event, x, selected, index) => show(x, rows[index]), unhighlightCallback: () => show(),
          ...padded, ...look, ...options.dygraph, ...(flat ? {includeZero: true} : {})});
      }
      show();
    });
    tools(box, ['Whole range', () => graph.resetZoom()], ['Save CSV', () => {
      const quote = t => '"' + t.replace(/"/g, '""') + '"';
      const text = [[xlabel, ...series.map(s => s.name + ', ' + ylabel)].map(quote).join(','),
                    ...rows.map(r => r.map(v => (known(v) ? v : '')).join(','))].join('\n') + '\n';
      save(title + '.csv', 'data:text/csv;charset=utf-8,' + encodeURIComponent(text));
    }]);
  }
  function map(parent, title, caption, m) {
    const figure = add(parent, 'figure', {class: 'map'}), canvas = add(figure, 'canvas', {role: 'img', 'aria-label': title});
    draw(() => pictures.map(canvas, m));
    if (caption) add(figure, 'figcaption', {}, caption);
    tools(figure, ['Save PNG', () => save(title + '.png', canvas.toDataURL('image/png'))]);
    return figure;
  }

  const zip = (x, y) => x.map((v, i) => [v, y[i]]);
  const span = (f, low, high, n) => Array.from({length: n + 1}, (_, i) => low + (high - low) * i / n).map(x => [x, f(x)]);

  /* Draws all, now that it has its place, and again when paper, width or colours change. */
  function start() {
    let width = document.body.clientWidth;
    placed = true;
    again();
    window.addEventListener('resize', () => {
      if (document.body.clientWidth === width) return;
      width = document.body.clientWidth;
      again();
    });
    /* Curves keep their width on paper: drawn anew after its layout they would be empty there. */
    const plots = width => document.querySelectorAll('.plot').forEach(p => { p.style.width = width(p); });
    window.addEventListener('beforeprint', () => {
      document.documentElement.classList.add('printed');
      plots(p => p.clientWidth + 'px');
      again();
    });
    window.addEventListener('afterprint', () => {
      document.documentElement.classList.remove('printed');
      plots(() => '');
      again();
    });
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', again);
  }
  return {data, by, css, add, known, number, short, percent, quantity, interval, size, duration, unitOf, speedUnit, pressureUnit,
          table, note, tools, save, chart, map, zip, span, draw, again, start};
})();
