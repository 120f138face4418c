/* Fills page.html from the JSON in it: text, tables, curves (dygraphs) and pictures (page_pictures.js). Nothing of a file
 * becomes markup: all of it is set as text. */
(function () {
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
    return [s.texts[0] + s.ten + ' ' + unit, open ? '' : `${s.texts[1]} to ${s.texts[2]}${s.ten} (95 %)`];
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
    rows = rows.filter(r => r && r[1] !== '' && r[1] !== undefined && r[1] !== null);
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
    const legend = add(box, 'div', {class: 'legend'}), lines = options.lines || [], names = new Set(['x']);
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
          labels: ['x', ...series.map(s => s.name)], connectSeparatedPoints: true, xlabel: xlabel, ylabel: ylabel, legend: 'never',
          axisLabelWidth: 62, xRangePad: 8, yRangePad: 12, labelsKMB: false, axes: {y: axis, x: {...axis, ...(options.logx ? {logscale: true} : {})}},
          underlayCallback: under, highlightCallback: (event, x, selected, index) => show(x, rows[index]), unhighlightCallback: () => show(),
          ...padded, ...look, ...options.dygraph});
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

  /* A unit as a file has it. */
  const written = unit => (!unit || unit === '1' ? '-' : unit.replace('^2', '²').replace('^3', '³'));
  const zip = (x, y) => x.map((v, i) => [v, y[i]]);
  const span = (f, low, high, n) => Array.from({length: n + 1}, (_, i) => low + (high - low) * i / n).map(x => [x, f(x)]);
  /* A density as steps: its last edge closes it; empty bins are gaps on a logarithmic axis. */
  const steps = (pdf, scale, offset, log) => {
    const points = pdf.density.map((d, i) => [pdf.bin_edges[i] * scale - offset, log && d <= 0 ? null : d / scale]);
    return [...points, [pdf.bin_edges[pdf.density.length] * scale - offset, points[points.length - 1][1]]];
  };

  /* ---- the answer ---- */
  const result = data.verdict[0], first = data.runs[0], run = first.run.attributes, seen = data.pictures;
  const PARTS = {resolution: 'resolution', scan: 'scan', sides: 'sides of the sample', sample: 'size of the sample', void_ratio: 'void ratio',
                 threshold: 'threshold', micro: 'soil below the voxel', averaging: 'averaging', steadiness: 'steadiness'};

  function budget(parent) {
    const parts = result.error_budget || {}, total = parts.total;
    if (!(total > 0) || !(result.k_m_per_s > 0)) return;
    const t = add(parent, 'table', {class: 'budget'}), body = add(t, 'tbody');
    add(t, 'caption', {}, 'What the error of k is made of');
    Object.entries(PARTS).forEach(([key, name]) => {
      if (!(parts[key] > 0)) return;
      const expected = key === 'resolution' && parts.resolution_from === 'expectation' ? ' (expected)' : '';
      const row = add(body, 'tr', {}, add(null, 'th', {scope: 'row'}, name + expected), add(null, 'td', {class: 'number'}, percent(parts[key])));
      add(add(row, 'td', {class: 'share'}), 'i').style.width = Math.min(100, 100 * parts[key] / total) + '%';
    });
    (result.notes || []).forEach(text => note(parent, text));
  }

  function orientation(parent) {
    if (!(result.k_m_per_s > 0)) return;
    const f = result.formulas, k = result.k_m_per_s;
    const kozeny = f && f.kozeny_carman;
    table(parent, [['DIN 18130-1', result.class_din], ['Casagrande', result.class_casagrande],
                   kozeny && ['Kozeny-Carman, from porosity and grain surface', `${number(100 * kozeny)} cm/s, ${number(kozeny / k, 2)} times this k`]],
          'For orientation (classes are those of water)');
  }

  function tensor(parent) {
    const t = data.tensor;
    if (!t) return;
    const box = add(parent, 'div', {class: 'wide'}), axes = ['x', 'y', 'z'];
    const cell = (i, j) => quantity(100 * t.k_m_per_s[i][j], 50 * (t.k_high_m_per_s[i][j] - t.k_low_m_per_s[i][j]), '').trim();
    const made = table(box, axes.map((a, i) => [a, ...axes.map((_, j) => cell(i, j))]),
                       'Permeability tensor, cm/s: flow along the row\u2019s axis under a gradient along the column\u2019s', ['', ...axes]);
    made.classList.add('tensor');
    const principal = p => interval(p.k_cm_per_s, 100 * p.k_low_m_per_s, 100 * p.k_high_m_per_s, 'cm/s').join(', ');
    table(box, t.principal.map(p => [`(${p.axis.map(v => v.toFixed(2)).join(', ')})`, principal(p)]),
          'Principal values along their axes').classList.add('tensor');
    note(parent, t.note);
  }

  function others(parent) {
    const rows = data.verdict.slice(1).map(r => [r.name, quantity(100 * r.k_m_per_s, 100 * r.k_relative_error * r.k_m_per_s, 'cm/s')]);
    data.runs.filter(r => !r.has_k && result).forEach(r => rows.push(
      [`${r.name} (${r.run.attributes.method})`, 'none: ' + (r.driven ? 'not settled' : 'see a page of its own')]));
    if (rows.length > 0) table(add(parent, 'div', {class: 'wide'}), rows, 'Further results', ['', 'k']);
    if (!result && data.runs.length > 1)
      note(parent, `Of ${first.name} alone; give ${data.runs.slice(1).map(r => r.name).join(', ')} pages of their own.`);
  }

  function answerOfK() {
    const k = 100 * result.k_m_per_s, unknown = (result.error_budget || {}).sides_unknown;
    const lines = [];
    const mean = v => 100 * v;
    if (known(result.k_low_image_m_per_s) && known(result.k_high_image_m_per_s))
      lines.push(['of this image', interval(k, mean(result.k_low_image_m_per_s), mean(result.k_high_image_m_per_s), 'cm/s')]);
    lines.push([lines.length > 0 ? 'of the material' : '', interval(k, mean(result.k_low_m_per_s), mean(result.k_high_m_per_s), 'cm/s')]);
    lines.forEach(([of, [value, range]], i) => {
      const line = by(i === 0 ? 'answer' : 'second');
      line.append(...(i === 0 ? [add(null, 'var', {}, 'k'), ' = ' + value] : []));
      const text = [of, range, unknown && i === lines.length - 1 ? 'sides not counted' : ''].filter(t => t).join(': ').replace(': sides', ', sides');
      if (text) add(line, 'span', {class: 'interval'}, (i === 0 ? ', ' : '') + text);
    });
    by('verdict').append(result.good_for.replace(/^./, c => c.toUpperCase()) + '. ' + result.advice);
    const area = result.intrinsic_permeability_m2, share = result.k_relative_error;
    table(by('units'), [[result.name, ''], ['Hydraulic conductivity k', quantity(result.k_m_per_s, share * result.k_m_per_s, 'm/s')],
                        ['Intrinsic permeability', quantity(area, share * area, 'm²')],
                        ['', quantity(area / 9.869233e-13, share * area / 9.869233e-13, 'darcy')]].filter(r => r[1]), result.name);
    note(by('units'), result.note);
    budget(by('budget'));
    orientation(by('orientation'));
    tensor(by('tensor'));
  }

  function answerOfHeadline() {
    const h = data.headline;
    by('answer').append(known(h.value) ? quantity(h.value, h.error, h.unit) : h.text || 'No permeability');
    if (known(h.value)) add(by('answer'), 'span', {class: 'interval'}, ' ' + h.text);
    by('verdict').append(h.sentence);
  }

  /* What was asked of a flow through soil: heads, fluxes, exit gradient, forces. */
  function asked(parent) {
    const s = data.seepage, rows = [];
    if (s) {
      Object.entries(s.fluxes_m2_per_s || {}).forEach(([name, f]) => rows.push([`Flux through ${name}`, quantity(f.mean, f.error95, 'm²/s')]));
      Object.entries(s.heads_m || {}).forEach(([name, f]) => rows.push([`Head at ${name}`, quantity(f.mean, f.error95, 'm')]));
      Object.entries(s.levels_m || {}).forEach(([name, f]) => rows.push([`Water level at ${name}`, quantity(f.mean, f.error95, 'm')]));
      const exit = s.exit || {};
      if (known(exit.gradient))
        rows.push([`Exit gradient at x = ${number(exit.x_m)} m`,
          `${quantity(exit.gradient, exit.error95, '').trim()}; critical ${number(exit.critical)}, ` +
          (known(exit.factor_of_safety) ? `factor of safety ${number(exit.factor_of_safety)}` : '') + (exit.resolved ? '' : ', not resolved')]);
      (s.heave || []).forEach(p => rows.push([`Heave beside wall ${p.wall} (${p.side}), ${number(p.depth_m)} m deep`,
                                             `factor of safety ${number(p.factor_of_safety)}` + (p.resolved ? '' : ', not resolved')]));
      const force = (w, axis) => `${quantity(1e-3 * w[`force_${axis}_N_per_m`], 1e-3 * w[`force_${axis}_error95`], 'kN')} along ${axis}`;
      (s.walls || []).forEach(w => rows.push([`Force on wall ${w.wall}, for each metre`, `${force(w, 'x')}, ${force(w, 'z')}`]));
    }
    const columns = !s && !result && data.history ? data.history.runs[0].columns : {};
    const names = {head: 'Head at', level: 'Water level at', flux: 'Flux through', force: 'Force on'};
    Object.entries(columns).forEach(([name, c]) => {
      const [, kind, of] = /^(head|level|flux|force)_(.+)$/.exec(name) || [], values = c.last.filter(known);
      if (kind && values.length > 0) rows.push([`${names[kind]} ${of} at the end`, values.map(v => number(v)).join(', ') + ' ' + written(c.unit)]);
    });
    (data.dispersion ? data.dispersion.runs || [data.dispersion] : []).forEach(d => rows.push(
      ['Solute: D along the flow over D of the solute', zip(d.peclet, d.longitudinal).slice(0, 8).map(([p, v]) => `${short(v)} at Pe ${short(p)}`).join(', ')]));
    table(parent, rows, rows.length > 0 ? 'What was asked' : undefined);
  }

  /* ---- scan ---- */
  const model = data.models[0], of = group => (model && model[group] ? model[group].attributes : {});
  const walls = {line: '#ff7a00', lineWidth: 1.5};

  function scan() {
    const slice = seen.slice, calibration = model && model.calibration, scanner = model && model.scanner;
    if (slice) {
      const m = {size: slice.size, spacing: slice.pixel_m, value: pictures.field(slice.grey), low: slice.grey.low, high: slice.grey.high,
                 palette: 'grey', axes: `${slice.across} across, ${slice.up} up`, distance: pictures.field(slice.distance), ...walls};
      const labels = data.model.rule === 'labels', what = labels ? 'distance to the walls drawn through the labels' : 'grey values of the scan';
      const figure = map(by('slice'), 'Slice', `The middle slice: ${what}, and the walls of the model (orange)`, m);
      const box = add(add(figure.querySelector('.tools'), 'label'), 'input', {type: 'checkbox', checked: ''});
      box.after(' walls');
      box.addEventListener('change', () => {
        m.line = box.checked ? walls.line : null;
        painters.forEach(f => f());
      });
    }
    if (calibration && calibration.threshold) {
      const c = calibration, a = c.attributes, t = c.threshold, grey = {colour: '--soft'};
      /* At the scan's own voxels the model's curves lie on those of the scan. */
      const same = c.void_ratio_original && c.void_ratio.every((e, i) => e > 3 || Math.abs(e - c.void_ratio_original[i]) < 0.01 * e + 1e-3);
      const share = values => values && zip(t, values.map(v => v / Math.max(...values)));
      const counts = c.histogram_original || c.histogram, all = counts.reduce((sum, n) => sum + n, 0);
      let above = all; /* a few bright voxels would take half of the axis */
      const last = t.find((_, i) => (above -= counts[i]) < 0.002 * all);
      const lines = [{x: a.threshold, name: 'threshold', colour: '--c1'}, {x: a.threshold_otsu, name: 'Otsu', ...grey},
                     {x: a.pore_peak, name: 'pore', ...grey}, {x: a.grain_peak, name: 'grain', ...grey}].filter(l => known(l.x));
      chart(by('histogram'), 'Histogram of grey values', 'Grey value', 'Voxels (of the most)',
            [{name: 'scan', points: share(c.histogram_original) || []}, !same && {name: 'model', points: share(c.histogram) || []}],
            {lines: lines, dygraph: {includeZero: true, dateWindow: [t[0], 1.05 * last]}});
      const measured = of('model').void_ratio_measured, most = 3 * (known(measured) ? measured : of('model').void_ratio);
      const curve = values => (values ? zip(t, values).filter(p => known(p[1]) && p[1] < most) : []);
      chart(by('calibration'), 'Void ratio by the threshold', 'Grey threshold', 'Void ratio (-)',
            [{name: 'scan', points: curve(c.void_ratio_original)}, !same && {name: 'model', points: curve(c.void_ratio)}],
            {lines: [lines[0], known(measured) && {y: measured, name: 'measured'}].filter(l => l), dygraph: {includeZero: true}});
    }
    if (scanner && scanner.edge_response) {
      const a = scanner.attributes, s = a.blur, f = a.fringe || 0;
      const bell = u => Math.exp(-u * u / 2) / Math.sqrt(2 * Math.PI);
      /* The normal integral by Abramowitz, Stegun 26.2.17. */
      const integral = u => {
        const w = 1 / (1 + 0.2316419 * Math.abs(u));
        const q = bell(u) * [1.330274429, -1.821255978, 1.781477937, -0.356563782, 0.31938153].reduce((sum, c) => (sum + c) * w, 0);
        return u > 0 ? 1 - q : q;
      };
      const points = zip(scanner.distance.map(d => 1e6 * d), scanner.edge_response).filter(p => p[1] !== null);
      const response = d => integral(-d / s) - f * d / s * bell(d / s);
      const misfit = shift => points.reduce((sum, [d, v]) => sum + Math.pow(response(1e-6 * d - shift) - v, 2), 0);
      const shift = span(misfit, -s, s, 80).reduce((best, p) => (p[1] < best[1] ? p : best))[0];
      const fit = d => response(d - shift);
      chart(by('calibration'), 'Edge response', 'Distance from the wall, into the pore (µm)', 'Grey (0 pore, 1 grain)',
            [{name: 'scan', points: points, dots: true},
             {name: `Gaussian of ${number(1e6 * s)} µm` + (f > 0 ? `, edge enhancement ${number(f, 2)}` : ''), colour: 1,
                                                          points: span(d => fit(1e-6 * d), points[0][0], points[points.length - 1][0], 120)}]);
      table(by('scanner'), [
        ['Blur (standard deviation)', quantity(1e6 * s, 1.96e6 * a.blur_uncertainty, 'µm') + ` = ${number(s / of('model').voxel_scanned)} voxels`],
        ['Resolution (10 % of the contrast remain)', size(a.resolution)], ['Contrast over noise', number(a.contrast_to_noise)],
        ['Noise, correlation length', size(a.noise_correlation)], known(a.fringe) && ['Edge enhancement (phase contrast)', number(a.fringe, 2)],
        ['Blur taken out of the walls', a.removed > 0 ? 'yes' : 'no']], 'Scanner');
    }
  }

  /* ---- flow ---- */
  /* Velocities are those of the finest lattice; times this they carry the flow that k says. */
  const rescale = data.velocity_scale;

  function flow() {
    const p = seen.plane, f = seen.flow;
    if (!p && !f) return;
    if (rescale !== 1 && f && f.speed_high > 0)
      by('flow-note').append(`Velocities are those of the finest lattice (${size(run.spacing[0])}) times ${number(rescale)}, ` +
                             'so that they carry the flow of the k above.');
    if (p) {
      const common = {size: p.size, spacing: p.spacing_m[0], distance: pictures.field(p.distance), fillGrains: true, smooth: true,
                      line: '#5d564a', soil: pictures.field(p.soil), axes: `${p.across} across, ${p.up} up`};
      const m = of('model'), mirrored = ['x', 'y', 'z'].filter((d, i) => d !== p.normal &&
        (m.mirror_axis === d || (m.sides === 'mirrored' && d !== 'z') || (run.mirrored || [])[i] > 0));
      const image = mirrored.length > 0 ? ` The sample is mirrored along ${mirrored.join(' and ')}.` : '';
      const high = rescale * p.speed.high, unit = speedUnit(high), soil = p.soil ? ' Hatched: soil with pores below the voxel.' : '';
      map(by('maps'), 'Speed', `Speed, with streamlines of the velocity in the plane ${p.normal} = ${size(p.at_m)}.${image}${soil}`,
          {...common, value: pictures.field(p.speed).map(v => rescale * v), low: 0, high: high, palette: 'speed', open: true,
           unit: {factor: unit[0], name: unit[1]}, direction: pictures.field(p.direction)});
      if (p.pressure) {
        const [factor, name] = pressureUnit(p.pressure.high);
        map(by('maps'), 'Pressure', 'Pressure about its mean, without what drives the flow, in the same plane.',
            {...common, value: pictures.field(p.pressure), low: p.pressure.low, high: p.pressure.high, palette: 'pressure',
             unit: {factor: factor, name: name}});
      }
    }
    if (f) solid(f);
  }

  function solid(f) {
    const figure = by('view'), box = add(figure, 'div', {class: 'view'}), flows = f.speed_high > 0;
    const unit = speedUnit(rescale * f.speed_high);
    let text = `Grains${flows ? ' and streamlines' : ''} of ${first.name}` +
      (flows ? `, from 0 (light) to ${number(unit[0] * rescale * f.speed_high)} ${unit[1]} (dark)` : '; the water rests');
    if (known(f.pore_share_of_half_the_flow))
      text += `. Half of the flow goes through ${percent(f.pore_share_of_half_the_flow)} of the pores\u2019 volume`;
    add(figure, 'figcaption', {}, text + '. Drag or arrow keys turn, wheel or + and \u2212 zoom.');
    let view;
    try {
      if (!window.THREE || !THREE.OrbitControls) throw new Error('the program was built without three.js');
      view = pictures.view(box, f);
    } catch (error) {
      box.classList.add('none');
      return void note(box, 'No view in three dimensions: ' + error.message);
    }
    const controls = add(box, 'div', {class: 'controls'});
    const slider = add(add(controls, 'label', {}, 'Cut '), 'input', {type: 'range', min: 0, max: 100, value: 55});
    slider.addEventListener('input', () => view.cut(slider.value / 100));
    if (f.paths) {
      const half = add(add(controls, 'label'), 'input', {type: 'checkbox'});
      half.after(' pores that carry half of the flow');
      half.addEventListener('change', () => view.show(half.checked));
    }
    view.cut(0.55);
    box.dataset.drawn = view.drawn();
    /* On paper stands a copy. */
    const copy = add(box, 'canvas', {class: 'copy'}), of = box.querySelector('canvas');
    draw(() => {
      view.draw();
      copy.width = of.width;
      copy.height = of.height;
      copy.getContext('2d').drawImage(of, 0, 0);
    });
  }

  function frames() {
    const f = seen.frames;
    if (!f) return;
    const wet = f.value === 'saturation', high = f.values[0].high, [factor, name] = wet ? [1, '-'] : pressureUnit(high);
    const regions = (first.regions && first.regions.box ? first.regions.box : []).filter((_, i) => first.regions.type[i] === 'porous');
    const ground = new Uint8Array(f.size[0] * f.size[1]);
    for (let k = 0; k < f.size[1]; k++)
      for (let i = 0; i < f.size[0]; i++) {
        const x = f.origin_m[0] + i * f.cell_m[0], z = f.origin_m[1] + k * f.cell_m[1];
        if (regions.some(b => x > b[0] && x < b[3] && z > b[2] && z < b[5])) ground[k * f.size[0] + i] = 1;
      }
    const soil = regions.length > 0;
    f.times_s.forEach((t, i) => {
      map(by('times'), duration(t), duration(t), {
        size: f.size, spacing: f.cell_m[0], value: pictures.field(f.values[i]), kinds: pictures.bytes(f.kinds[i]), low: 0, high: high,
        palette: wet ? 'saturation' : 'water', ground: ground, hatch: !wet, most: 340, axes: 'x across, z up',
        unit: {factor: factor, name: name}});
    });
    note(by('frames'), wet ? 'Saturation: the share of the pores that is full of water.' :
      `Pressure of the water${soil ? '; hatched: water in soil, sand-coloured: soil without water' : ''}, grey: walls.`);
  }

  /* ---- accuracy ---- */
  function levels() {
    const l = first.levels;
    if (!l || l.spacing.length < 2 || !result || data.runs.length > 1) return;
    const x = l.spacing.map(h => 1e6 * h), k = 100 * result.k_m_per_s;
    /* What each lattice and those before say of the limit, where that is better than nothing; the last is the result. */
    const so_far = l.estimate ? x.map((h, i) => [h, 100 * l.estimate[i], l.low[i], l.high[i]]).slice(0, -1).filter(e => known(e[2]) && e[2] < 1) : [];
    chart(by('spacings'), 'k against spacing', 'Spacing of the lattice (µm)', 'k (cm/s)',
          [{name: 'each lattice', points: zip(x, l.k.map(v => 100 * v)), dots: true},
           {name: 'estimate of the limit so far, resolution alone', dots: true, colour: 2, points: so_far.map(e => [e[0], e[1]]),
            low: so_far.map(e => e[1] * (1 - e[2])), high: so_far.map(e => e[1] * (1 + e[3]))},
           {name: 'result, 95 %', dots: true, colour: 1, points: [[0, k]], low: [100 * result.k_low_m_per_s], high: [100 * result.k_high_m_per_s]}],
          {dygraph: {includeZero: true, dateWindow: [-0.05 * x[0], 1.08 * x[0]]}});
  }

  /* How much k of a window of a size differs from the next, by its void ratio alone. */
  function sampleSize() {
    const q = model && model.quality, slope = result && Math.abs(result.dlnk_dvoid_ratio);
    if (!q || !q.window || !known(slope)) return;
    const points = q.window.map((w, i) => [1e3 * w, q.windows[i] > 1 ? 100 * slope * q.void_ratio_deviation[i] : null]).filter(p => p[1] > 0);
    chart(by('spacings'), 'k against the size of the sample', 'Side of a cube cut from the sample (mm)', 'Spread of k by its void ratio (%)',
          [{name: 'standard deviation from one cube to the next', points: points, dots: true, joined: true}],
          {logx: true, dygraph: {logscale: true, valueRange: [Math.min(5, 0.7 * Math.min(...points.map(p => p[1]))), null]}, lines: [{y: 10, name: '10 %'}]});
  }

  /* ---- analyses ---- */
  const charts = {
    darcy(parent, darcy) {
      chart(parent, 'Darcy velocity', 'Hydraulic gradient (-)', 'Darcy velocity (cm/s)', darcy.groups.flatMap((g, i) => {
        const most = Math.max(...g.runs.map(r => r.hydraulic_gradient)), k = g.k_m_per_s, f = g.forchheimer;
        const b = f && f.called_for ? f.b_s2_per_m2 : 0;
        const v = x => 100 * (b > 0 ? 2 * x / (1 / k + Math.sqrt(1 / (k * k) + 4 * b * x)) : k * x);
        return [k !== null && {name: g.name + ', fit', points: span(v, 0, 1.05 * most, b > 0 ? 60 : 1), colour: i},
                {name: g.name, dots: true, colour: i, points: g.runs.map(r => [r.hydraulic_gradient, 100 * r.darcy_velocity_m_per_s])}];
      }), {dygraph: {includeZero: true}});
    },
    converge(parent, converge) {
      chart(parent, 'k against spacing', 'Spacing (µm)', 'k (cm/s)', converge.series.flatMap((s, i) => {
        const name = s.method + (s.wall ? ', ' + s.wall + ' walls' : ''), widest = Math.max(...s.runs.map(r => r.spacing_m));
        const perArea = s.k_cm_per_s / s.intrinsic_permeability_m2;
        const fit = h => perArea * (s.intrinsic_permeability_m2 + s.fit.slope_m2_per_m_to_the_order * Math.pow(h, s.fit.order));
        return [{name: name, dots: true, colour: i, points: s.runs.map(r => [1e6 * r.spacing_m, 100 * r.k_m_per_s])},
                s.extrapolated && s.k_m_per_s !== null && {name: name + ', fit', colour: i, points: span(h => fit(h * 1e-6), 0, 1e6 * widest, 80)}];
      }), {dygraph: {includeZero: true}});
    },
    pdf(parent, pdf) {
      const scale = r => (data.runs.length === 1 ? rescale : 1);
      const [factor, unit] = speedUnit(Math.max(...pdf.runs.map(r => r.pdf_m_per_s.bin_edges[r.pdf_m_per_s.density.length])));
      chart(parent, 'Velocity along the force', `Velocity (${unit})`, `Probability density (1/(${unit}))`,
            pdf.runs.map(r => ({name: r.name, step: true, points: steps(r.pdf_m_per_s, factor * scale(r), 0, true)})), {dygraph: {logscale: true}});
      const densities = pdf.runs.flatMap(r => r.pdf.density).filter(d => d > 0), widest = Math.max(...pdf.runs.map(r => r.normalised_velocity_max));
      const references = pdf.references.filter(r => /exponential/.test(r.name)).map((r, i) => ({
        name: r.name === 'power-exponential' ? `${r.name}, γ = ${pdf.runs[0].power_exponential.gamma.toFixed(2)}` : r.name,
        colour: '--soft', dash: [[7, 3], [2, 3]][i % 2],
        points: zip(r.normalised_velocity, r.density).filter(q => q[1] > 0.5 * Math.min(...densities) && q[0] < widest)}));
      chart(parent, 'Velocity over the mean in the pores', 'Velocity / mean in the pores (-)', 'Probability density (-)',
            [...pdf.runs.map(r => ({name: r.name, step: true, points: steps(r.pdf, 1, 0, true)})), ...references], {dygraph: {logscale: true}});
      const rows = [['Mean in the pores', r => number(factor * scale(r) * r.pore_mean_m_per_s) + ' ' + unit],
                    ['Fastest over the mean', r => number(r.normalised_velocity_max)],
                    ['Flowing backwards', r => percent(r.backward_fraction)], ['Tortuosity (mean speed over mean velocity)', r => number(r.tortuosity)],
                    ['Standard deviation over the mean', r => number(r.standard_deviation)]];
      table(add(parent.parentNode, 'div', {class: 'wide'}), rows.map(([name, f]) => [name, ...pdf.runs.map(f)]), undefined,
            pdf.runs.length > 1 ? ['', ...pdf.runs.map(r => r.name)] : undefined);
    },
    history(parent, history) {
      const runs = history.runs, end = Math.max(...runs.map(r => r.end_time_s || 0));
      const [scale, time] = end < 0.1 ? [1e3, 'Time (ms)'] : end > 7200 ? [1 / 3600, 'Time (h)'] : [1, 'Time (s)'];
      const series = (r, values, f) => (values && r.time_s ? r.time_s.map((t, i) => [t * scale, values[i] === null ? null : f(values[i])]) : []);
      const varies = values => values && values.some(v => v !== values[0]);
      const rise = r => series(r, r.density_max_series_kg_per_m3, v => 100 * (v / r.density_reference_kg_per_m3 - 1));
      const list = [
        ['Darcy velocity', 'Darcy velocity (cm/s)', runs.map(r => ({name: r.name, points: series(r, r.darcy_velocity_series_m_per_s, v => 100 * v)})), {}],
        ['Maximum density', 'Above reference (%)',
         runs.map(r => ({name: r.name, points: r.stationary || !varies(r.density_max_series_kg_per_m3) ? [] : rise(r)})), {}]];
      /* What the scene asked for comes first, all gauges or planes of a kind together; the solver's own records wait behind a fold. */
      const kinds = /^(head|level|flux|force|pressure|velocity|water_content|infiltration|inflow|entered|fallen|ran_off)_(?!rms)(.+)$/;
      const groups = new Map();
      Object.entries(runs[0].columns).filter(([name]) => !name.startsWith('work_')).forEach(([name, column]) => {
        const asked = kinds.exec(name) && name !== 'velocity_through_soil' && kinds.exec(name), key = asked ? asked[1] : name;
        const group = groups.get(key) || {asked: !!asked, unit: column.unit, lines: []};
        groups.set(key, group);
        runs.forEach(r => (r.columns[name] ? r.columns[name].series : []).forEach((values, d, all) => {
          if ((all.length > 1 && d === 1 && r.dimensions === 2) || values.every(v => v === null)) return;
          const words = [runs.length > 1 || !asked ? r.name : '', asked ? asked[2].replace(/_/g, ' ') : '', all.length > 1 ? 'xyz'[d] : ''];
          group.lines.push({name: words.filter(w => w).join(', '), points: series(r, values, v => v)});
        }));
      });
      groups.forEach((group, key) => {
        const all = group.lines.flatMap(l => l.points.map(p => p[1])).filter(known), words = key.replace(/_/g, ' '), low = Math.min(...all);
        const title = words[0].toUpperCase() + words.slice(1), unit = written(group.unit);
        if (all.length > 0)
          list.push([title, `${title} (${unit})`, group.lines, low > 0 && Math.max(...all) > 1e3 * low ? {logscale: true} : {}, group.asked]);
      });
      const wanted = list.filter(t => t[4]), shown = wanted.length > 0 ? wanted : list.slice(0, 2);
      const hidden = list.filter(t => !shown.includes(t) && t[2].some(s => s.points.length > 0));
      const all = (place, some) => some.forEach(([title, label, lines, options]) => chart(place, title, time, label, lines, {dygraph: options}));
      all(parent, shown);
      if (hidden.length === 0) return;
      const fold = add(parent.parentNode, 'details');
      add(fold, 'summary', {}, `${hidden.length} more: ${hidden.map(t => t[0].toLowerCase()).join(', ')}`);
      const box = add(fold, 'div', {class: 'charts'});
      fold.addEventListener('toggle', () => { /* charts have no width before it opens */
        if (box.childNodes.length === 0) all(box, hidden);
      });
    },
    dispersion(parent, dispersion) {
      const runs = dispersion.runs || [dispersion];
      const lines = (key, name, c) => runs.map(d => {
        const errors = d[key + '_error'] || [], of = runs.length > 1 ? `${name}, ${(d.path || '').replace(/.*\//, '')}` : name;
        /* Along an axis of one cell nothing spreads. */
        const rows = d.peclet.map((p, i) => [p, d[key][i], errors[i] || 0]).filter(r => r[0] > 0 && r[1] > 1e-6);
        return {name: of, points: rows.map(r => [r[0], r[1]]), dots: true, colour: c,
                low: rows.map(r => r[1] * (1 - Math.min(r[2], 0.99))), high: rows.map(r => r[1] * (1 + r[2]))};
      });
      chart(parent, 'Dispersion', 'Peclet number (-)', 'D along or across the flow / D (-)',
            [...lines('longitudinal', 'along the flow', 0), ...lines('transverse', 'across the flow', 1)],
            {logx: true, dygraph: {logscale: true}});
    }
  };

  function sections() {
    data.sections.forEach(s => {
      const asked = ['dispersion', 'breakthrough', 'film'].includes(s.name);
      const section = add(by(asked ? 'solute' : 'analyses'), 'section', {id: s.name}, add(null, 'h2', {}, s.heading));
      if (charts[s.name] && !s.svg) {
        charts[s.name](add(section, 'div', {class: 'charts'}), data[s.name]);
        note(section, s.caption);
        return;
      }
      const figure = add(section, 'figure');
      if (s.svg) {
        add(figure, 'img', {class: 'still', src: 'data:image/svg+xml;base64,' + s.svg, width: s.width, height: s.height, alt: s.heading});
        tools(figure, ['Save SVG', () => save(s.name + '.svg', 'data:image/svg+xml;base64,' + s.svg)]);
      }
      add(figure, 'figcaption', {}, s.caption);
      add(add(section, 'details', {}, add(null, 'summary', {}, 'Numbers')), 'pre', {}, s.summary);
    });
    if (result && result.k_m_per_s === 0)
      add(by('analyses'), 'section', {id: 'blocked'}, add(null, 'h2', {}, 'Pore velocity'),
          add(null, 'p', {}, 'No pore leads through the model along the force: the water is at rest, and there is no velocity to show.'));
  }

  /* ---- specimen, soil, methods, effects, provenance ---- */
  function soil() {
    const m = first.micro, a = m && m.attributes;
    if (!m) return;
    by('soil-text').append(`${percent(a.sites)} of the sites are soil of porosity ${number(a.porosity, 2)} and permeability ` +
      `${number(a.permeability)} m² (geometric mean). ${percent(a.flux_share)} of the flux goes through it, and its drag takes ` +
      `${percent(a.dlnk_dlnk_micro)} of the power that drives the flow: 10 % more permeability of the soil is ` +
      `${number(10 * a.dlnk_dlnk_micro, 2)} % more k.`);
    if (!m.factor || m.factor.length < 2) return;
    const against = (title, label, name, values) => chart(by('soil-chart'), title, 'Permeability of the soil (m²)', label,
      [{name: name, points: zip(m.factor.map(f => f * a.permeability), values.map(v => 100 * v))}], {logx: true, dygraph: {includeZero: true}});
    against('k by the permeability of the soil', 'k (cm/s)', 'k', m.k);
    against('Flux through soil', 'Share of the flux (%)', 'flux through soil', m.flux_share);
  }

  function specimen() {
    const state = data.model.state;
    by('specimen-note').append({none: 'The scene has no scanned model; its domain and regions stand in the scene file below.', found: '',
                                changed: `The model file ${run.model_path} is not the one that was run: it was changed or replaced since.`,
                                missing: `The model file ${run.model_path} could not be read when this page was made.`}[state]);
    if (!model) return;
    const m = of('model'), c = of('calibration'), count = run.size, walls = data.model.void_ratio_walls, um = v => known(v) && size(v);
    const within = known(walls) && Math.abs(walls - m.void_ratio) > 1e-6;
    table(by('facts'), [
      ['Model file', data.model.path.replace(/.*\//, '')], ['Voxel', m.spacing && um(m.spacing[2])], ['Voxel of the scan', um(m.voxel_scanned)],
      ['Lattice of the flow', count && `${count.join(' × ')} points of ${size(run.spacing[0])}`],
      ['Void ratio, measured on the specimen', number(m.void_ratio_measured)],
      [!within ? 'Void ratio of the model' : data.model.rule === 'labels' ? 'Void ratio by voxels of the smoothed labels' :
        'Void ratio of the model, by voxels', number(m.void_ratio)],
      within && ['Void ratio within its walls, which are used', number(walls)], ['Porosity', number(m.porosity)],
      ['Connected porosity', number(m.connected_porosity)],
      ['Grey threshold', known(m.threshold) && number(m.threshold)], ['Otsu\u2019s threshold, for comparison', number(c.threshold_otsu)],
      ['Change of the threshold with the void ratio',
       known(c.dthreshold_dvoid_ratio) && `${number(c.dthreshold_dvoid_ratio / 100)} grey levels for each 0.01`]], 'Model');
    const lead = m.percolates && ['x', 'y', 'z'].filter((_, i) => m.percolates[2 - i] > 0).join(', ');
    table(by('quality'), [
      ['A pore path leads through along', m.percolates && (lead || 'no axis')],
      ['Specific surface', known(m.specific_surface) && quantity(1e-3 * m.specific_surface, 1e-3 * m.specific_surface_error, '1/mm of bulk volume')],
      ['Sauter diameter of the grains (6 volumes / surface)',
       known(m.specific_surface) && known(m.porosity) && um(6 * (1 - m.porosity) / m.specific_surface)],
      ['Median pore width', known(m.local_thickness_median) && um(m.local_thickness_median * m.spacing[2])],
      ['Width of the narrowest throat of the widest way along z', known(m.critical_width) && um(m.critical_width * m.spacing[2])],
      ['Correlation length', um(m.correlation_length)],
      ['Pore voxels that touch a grain', known(m.pore_voxels_touching_grain) && percent(m.pore_voxels_touching_grain)],
      ['Isolated pores (on no path along z)', known(m.isolated_pores) && String(m.isolated_pores)],
      ['Floating grains (touch no other, nor a side)', known(m.floating_grains) && String(m.floating_grains)]], 'Pores and grains');
    const widths = model.quality && model.quality.local_thickness, voxel = m.spacing && 1e6 * m.spacing[2];
    if (widths) {
      const last = widths.reduce((n, w, i) => (w > 0 ? i : n), 0);
      chart(by('sizes'), 'Pore widths', 'Width of the pore (µm)', 'Share of the pores (%)',
            [{name: 'by the largest ball that fits there', bars: true, points: widths.slice(0, last + 1).map((w, i) => [(i + 0.5) * voxel, 100 * w])}],
            {dygraph: {includeZero: true, dateWindow: [0, (last + 1) * voxel]}});
    }
    const g = data.grain_sizes;
    if (g)
      chart(by('sizes'), 'Grain sizes', 'Diameter (µm)', 'Finer (% of the grains\u2019 volume)',
            [{name: 'by the largest ball that fits there', points: zip(g.diameter_m.map(d => 1e6 * d), g.finer.map(f => 100 * f))}],
            {logx: true, dygraph: {includeZero: true}});
  }

  function methods() {
    by('methods-text').append(data.methods.text);
    data.methods.references.forEach(r => add(by('references'), 'li', {}, r));
  }

  function effects() {
    const e = first.effects, t = first.timing;
    if (e && e.name) {
      const rows = on => e.name.map((name, i) => [name, e.reason[i], e.model[i] + (e.citation[i] ? ` (${e.citation[i]})` : '')])
        .filter((_, i) => (e.state[i] === 'on') === on);
      table(by('effects-table'), rows(true), undefined, ['Effect', 'Why', 'Model']);
      table(add(by('passes'), 'div', {class: 'wide'}), rows(false), 'Off', ['Effect', 'Why', 'Model']);
    }
    if (t && t.name) table(by('passes'), t.name.map((name, i) => [name, `${number(t.seconds[i])} s`]), 'Passes');
    data.runs.forEach(r => ledger(by('ledger'), r));
    if (by('ledger').children.length < 2) by('ledger').remove();
  }

  /* What each effect gave the water over a run, or how well a steady flow is balanced. */
  function ledger(parent, r) {
    const l = r.ledger, a = l && l.attributes, value = v => Number((v + 0).toPrecision(4));
    if (!l) return;
    if (known(a.flux_open))
      return void add(parent, 'p', {}, `${r.name}: the flux is the same through all planes across the flow to ${percent(a.flux_open)} (rms); ` +
        `walls and pressure balance what drives the flow to ${percent(a.force_open)}; friction takes what drives the flow gives to ` +
        `${percent(a.power_open)}.`);
    if (!l.words) return;
    add(parent, 'p', {}, `${r.name}: ${a.particles_start} particles at the start, ${a.particles_entered} came in, ${a.particles_left} went out, ` +
        `${a.particles_lost} were lost, ${a.particles_end} at the end, ${a.particles_open} unaccounted for. ` +
        `Mass: ${value(a.mass_end)} kg at the end, open by ${number(a.mass_open, 2)} kg.`);
    const row = (name, p, energy) => [name, ...p.map(value), value(energy)].map(String);
    const terms = [0, 1].flatMap(numerical => l.words.map((w, i) => l.numerical[i] === numerical &&
      row(w + (numerical ? ' (numerical)' : ''), l.impulse[i], l.work[i])));
    table(add(parent, 'div', {class: 'wide'}),
          [row('there at the start', a.account_momentum_start, a.energy_start), ...terms,
           row('not accounted for', a.momentum_open, a.energy_open), row('there at the end', a.account_momentum_end, a.energy_end)],
          'Given to the water', ['', 'momentum x, kg m/s', 'y', 'z', 'energy, J']);
    add(parent, 'p', {}, `Not accounted for: ${percent(a.momentum_open_share)} of the largest term of the momentum, ` +
        `${percent(a.energy_open_share)} of that of the energy.`);
  }

  function provenance() {
    const value = v => (Array.isArray(v) ? v.map(short).join(', ') : typeof v === 'number' ? String(Number(v.toPrecision(8))) :
      v === null ? 'none' : v);
    [...data.runs, ...data.models, ...data.solutes].forEach(file => {
      const fold = add(by('provenance'), 'details', {}, add(null, 'summary', {}, file.name + ' ', add(null, 'span', {class: 'path'}, file.path)));
      const p = file.provenance || {attributes: {}}, box = add(fold, 'div', {class: 'wide'});
      const inputs = (p.input_files || []).map((name, i) => [`input, XXH3 ${p.input_hashes[i]}`, name]);
      table(box, [...Object.entries(p.attributes), ...inputs].map(([k, v]) => [k, value(v)]));
      if (file.run) table(box, Object.entries(file.run.attributes).map(([k, v]) => [k, value(v)]), 'Run');
      if (file.run && file.run.scene) add(fold, 'pre', {}, file.run.scene);
    });
  }

  function header() {
    document.title = `${data.title} - Tosui report`;
    by('title').textContent = data.title;
    const n = data.runs.length, stopped = data.runs.filter(r => r.run.attributes.status === 'interrupted').length, p = first.provenance;
    const parts = [`${n} run${n > 1 ? 's' : ''}` + (data.solutes.length > 0 ? ` of flow, ${data.solutes.length} of a solute in it` : '')];
    if (stopped > 0) parts.push(n > 1 ? `${stopped} of them interrupted` : 'interrupted');
    if (p && p.attributes.time) parts.push(p.attributes.time.slice(0, 10));
    if (data.model.origin) parts.push(data.model.origin);
    by('subtitle').append(parts.join(', '));
    by('made').append(`Made by analyze of Tosui ${data.version} with `, add(null, 'code', {}, data.command_line),
                      '. Curves: dygraphs, three dimensions: three.js (both MIT licence).');
  }

  /* A section without content goes; the others are listed. */
  function contents() {
    document.querySelectorAll('figure:empty, .charts:empty, .note:empty, .pair > div:empty, p:empty').forEach(e => e.remove());
    const names = {...Object.fromEntries(data.sections.map(s => [s.name, s.contents])),
                   blocked: 'Pore velocity', frames: 'In time', soil: 'Soil', scan: 'Scan', effects: 'Effects'};
    document.querySelectorAll('main section').forEach(s => {
      if (s.id === 'headline') return;
      if (!s.querySelector('canvas, table, img, p, .plot, .note, details > :nth-child(2)')) s.remove();
      else add(by('nav'), 'a', {href: '#' + s.id}, names[s.id] || s.querySelector('h2').textContent);
    });
  }

  header();
  if (result) answerOfK();
  else answerOfHeadline();
  asked(by('asked'));
  others(by('others'));
  [scan, frames, flow, levels, sampleSize, sections, soil, specimen, methods, effects, provenance, contents].forEach(f => f());

  let width = document.body.clientWidth;
  const again = () => painters.forEach(f => f());
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
})();
