/* Fills page.html from the JSON in it, with the parts of page_charts.js, page_maps.js and page_solid.js. */
(function () {
  'use strict';
  const {by, add, known, number, short, percent, quantity, interval, size, duration, speedUnit, pressureUnit, table, note, tools,
         save, chart, map, zip, span, draw, again, start} = tosui;

  const data = words.fill(tosui.data);
  /* ---- the answer ---- */
  const result = data.verdict[0], first = data.runs[0], run = first.run.attributes, seen = data.pictures;
  const PARTS = {resolution: 'resolution', scan: 'scan', sides: 'sides of the sample', sample: 'size of the sample', void_ratio: 'void ratio',
                 threshold: 'threshold', micro: 'soil below the voxel', averaging: 'averaging', steadiness: 'steadiness'};

  function budget(parent) {
    const parts = result.error_budget || {}, total = parts.total;
    if (!(total > 1e-6) || !(result.k_m_per_s > 0)) return;
    const t = add(parent, 'table', {class: 'budget'}), body = add(t, 'tbody');
    add(t, 'caption', {}, 'What the error of k is made of');
    parts.shown.forEach(key => {
      const name = PARTS[key] || key.replace(/_/g, ' ');
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

  /* ---- what the page begins with ---- */
  /* Of a solute: how many times as fast it spreads as by diffusion alone, at the i-th Peclet number. */
  const solutes = data.dispersion ? data.dispersion.runs || [data.dispersion] : [];
  const dispersion = (d, i) => ['longitudinal', 'transverse'].map(key => quantity(d[key][i], (d[key + '_error'] || [])[i] * d[key][i] || 0, '').trim() + ' D');
  const aside = (parent, text) => add(parent, 'span', {class: 'interval'}, text);

  function answerOfSolute() {
    const d = solutes[0], last = d.peclet.length - 1, [along, across] = dispersion(d, last);
    by('answer').append(`Dispersion ${along}`);
    aside(by('answer'), ` along the flow, ${across} across it, at Pe ${short(d.peclet[last])}; D is the diffusion of the solute`);
  }

  function answerOfHeadline() {
    const h = data.headline;
    by('answer').append(known(h.value) ? quantity(h.value, h.error, h.unit) : h.text || 'No permeability');
    if (known(h.value)) aside(by('answer'), ' ' + h.text);
    by('verdict').append(h.sentence);
  }

  /* k, and its interval of this image and of its material: one where they are alike, or no image was taken. */
  function intervals() {
    const of = (low, high) => interval(100 * result.k_m_per_s, 100 * low, 100 * high, 'cm/s');
    const [value, material] = of(result.k_low_m_per_s, result.k_high_m_per_s), image = of(result.k_low_image_m_per_s, result.k_high_image_m_per_s)[1];
    const rest = material && (result.error_budget || {}).sides_unknown ? ', sides not counted' : '';
    if (!image || data.model.state === 'none') return [value, material && material + rest];
    return image === material ? [value, `of this image and of the material: ${image}${rest}`] : [value, 'of this image: ' + image, `of the material: ${material}${rest}`];
  }

  function answerOfK() {
    const begun = by('answer').hasChildNodes(), [value, ...ranges] = intervals(), line = by(begun ? 'second' : 'answer');
    line.append(add(null, 'var', {}, 'k'), ' = ' + value);
    ranges.forEach((range, i) => range && aside(i === 0 ? line : by('second'), (i === 0 ? ', ' : begun ? '; ' : '') + range));
    if (!data.headline) by('verdict').append(result.good_for.replace(/^./, c => c.toUpperCase()) + '. ' + result.advice);
    const area = result.intrinsic_permeability_m2, share = result.k_relative_error < 1 ? result.k_relative_error : 0;
    table(by('units'), [['Hydraulic conductivity k', quantity(result.k_m_per_s, share * result.k_m_per_s, 'm/s')],
                        ['Intrinsic permeability', quantity(area, share * area, 'm²')],
                        ['', quantity(area / 9.869233e-13, share * area / 9.869233e-13, 'darcy')]], result.name);
    note(by('units'), result.note);
    budget(by('budget'));
    orientation(by('orientation'));
    tensor(by('tensor'));
  }

  /* What the scene asks for: heads, fluxes, exit gradient, forces; dispersion. */
  const WHERE = {flux: ['fluxes_m2_per_s', 'Flux through', 'm²/s'], head: ['heads_m', 'Head at', 'm'], level: ['levels_m', 'Water level at', 'm'],
                 force: ['', 'Force on', 'N']};

  function ofSeepage(s) {
    const exit = s.exit || {}, wall = w => (/^\d+$/.test(w.wall) ? `the wall regions[${w.wall}]` : `wall ${w.wall}`);
    const force = (w, axis) => `${quantity(1e-3 * w[`force_${axis}_N_per_m`], 1e-3 * w[`force_${axis}_error95`], 'kN/m')} along ${axis}`;
    const resolved = one => (one.resolved ? '' : ', not resolved');
    return [
      ...Object.values(WHERE).flatMap(([key, what, unit]) => Object.entries(s[key] || {}).map(([name, f]) => [`${what} ${name}`, quantity(f.mean, f.error95, unit)])),
      ...(s.seepage_faces || []).map(f => [`Water comes out of the soil at x = ${number(f.x_m)} m, up to`, quantity(f.z_m, f.error95, 'm')]),
      known(exit.gradient) && [`Exit gradient at x = ${number(exit.x_m)} m`, `${quantity(exit.gradient, exit.error95, '').trim()}; critical ${number(exit.critical)}` +
        (known(exit.factor_of_safety) ? `, factor of safety ${number(exit.factor_of_safety)}` : '') + resolved(exit)],
      ...(s.heave || []).map(p => [`Heave beside ${wall(p)} (${p.side}), ${number(p.depth_m)} m deep`, `factor of safety ${number(p.factor_of_safety)}${resolved(p)}`]),
      ...(s.walls || []).map(w => [`Force on ${wall(w)}, for each metre along y`, `${force(w, 'x')}, ${force(w, 'z')}`])];
  }

  /* Of a run without an analysis of its seepage: the last values of its record. */
  function ofHistory(columns) {
    return Object.entries(columns).map(([name, c]) => {
      const [, kind, of] = /^(head|level|flux|force)_(.+)$/.exec(name) || [], values = c.last.filter(known), unit = (c.unit || '-').replace('^2', '²').replace('^3', '³');
      return kind && values.length > 0 && [`${WHERE[kind][1]} ${of} at the end`, values.map(v => number(v)).join(', ') + ' ' + unit];
    });
  }

  function asked(parent) {
    const rows = data.seepage ? ofSeepage(data.seepage) : !result && data.history ? ofHistory(data.history.runs[0].columns) : [];
    solutes.forEach(d => d.peclet.slice(0, 8).forEach((p, i) => rows.push([`Dispersion at Pe ${short(p)}`, dispersion(d, i).join(' along the flow, ') + ' across it'])));
    table(parent, rows, 'Results');
  }

  /* ---- scan ---- */
  const model = data.models[0], of = group => (model && model[group] ? model[group].attributes : {});

  function scan() {
    const slice = seen.slice, calibration = model && model.calibration, scanner = model && model.scanner;
    if (slice) {
      const labels = data.model.rule === 'labels', what = labels ? 'distance to the walls drawn through the labels' : 'grey values of the scan';
      scans.slice(by('slice'), 'Slice', `The middle slice: ${what}, and the walls of the model (orange)`,
                  {size: slice.size, spacing: slice.pixel_m, value: pictures.upright(slice.grey, slice.size), low: slice.grey.low, high: slice.grey.high,
                   axes: `${slice.across} across, ${slice.up} down`, distance: pictures.upright(slice.distance, slice.size)});
    }
    if (calibration && calibration.threshold) {
      const c = calibration, a = c.attributes, t = c.threshold, measured = of('model').void_ratio_measured;
      /* At the scan's own voxels the model's curves lie on those of the scan. */
      const same = c.void_ratio_original && c.void_ratio.every((e, i) => e > 3 || Math.abs(e - c.void_ratio_original[i]) < 0.01 * e + 1e-3);
      scans.greys(by('histogram'), by('calibration'),
                  [c.void_ratio_original && {name: 'scan', threshold: t, counts: c.histogram_original, void_ratio: c.void_ratio_original},
                   !same && {name: 'model', threshold: t, counts: c.histogram, void_ratio: c.void_ratio}].filter(curve => curve),
                  {threshold: a.threshold, otsu: a.threshold_otsu, pore: a.pore_peak, grain: a.grain_peak, measured: measured},
                  3 * (known(measured) ? measured : of('model').void_ratio));
    }
    if (scanner && scanner.edge_response) {
      const a = scanner.attributes;
      scans.edge(by('calibration'), scanner.distance, scanner.edge_response, a.blur, a.fringe || 0);
      table(by('scanner'), [...scans.rows(a, of('model').voxel_scanned), ['Blur taken out of the walls', a.removed > 0 ? 'yes' : 'no']], 'Scanner');
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
      const mirrored = words.mirrored(run, of('model')).filter(d => d !== p.normal);
      const image = mirrored.length > 0 ? ` The sample is mirrored along ${mirrored.join(' and ')}.` : '';
      const high = rescale * p.speed.high, unit = speedUnit(high), soil = p.soil ? ' Hatched: soil with pores below the voxel.' : '';
      map(by('maps'), 'Speed', `Speed, with streamlines of the velocity in the plane ${p.normal} = ${size(p.at_m)}.${image}${soil}`,
          {...common, value: pictures.field(p.speed).map(v => rescale * v), low: 0, high: high, palette: 'speed', open: true,
           unit: {factor: unit[0], name: unit[1]}, direction: pictures.field(p.direction)});
      if (p.pressure) {
        const [factor, name] = pressureUnit(p.pressure.high);
        map(by('maps'), 'Pressure', 'Pressure about its mean, without what drives the flow, in the same plane.',
            {...common, value: pictures.spread(pictures.field(p.pressure), p.size), low: p.pressure.low, high: p.pressure.high, palette: 'pressure',
             unit: {factor: factor, name: name}});
      }
    }
    if (f) inSpace(f);
  }

  function inSpace(f) {
    const figure = by('view'), box = add(figure, 'div', {class: 'view'}), flows = f.speed_high > 0;
    const unit = speedUnit(rescale * f.speed_high);
    let text = `Grains${flows ? ' and streamlines' : ''} of ${first.name}` +
      (flows ? `, from 0 (light) to ${number(unit[0] * rescale * f.speed_high)} ${unit[1]} (dark)` : '; the water rests');
    if (known(f.pore_share_of_half_the_flow))
      text += `. Half of the flow goes through ${percent(f.pore_share_of_half_the_flow)} of the pores\u2019 volume`;
    add(figure, 'figcaption', {}, text + '. ', add(null, 'span', {class: 'hint'}, 'Drag or arrow keys turn, wheel or + and \u2212 zoom.'));
    let view;
    try {
      if (!window.THREE || !THREE.OrbitControls) throw new Error('the program was built without three.js');
      view = solid.view(box, f);
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
    const wet = f.value === 'saturation', high = f.values[0].high, [factor, name] = wet ? [1, ''] : pressureUnit(high);
    const regions = (first.regions && first.regions.box ? first.regions.box : []).filter((_, i) => first.regions.type[i] === 'porous');
    const ground = new Uint8Array(f.size[0] * f.size[1]);
    for (let k = 0; k < f.size[1]; k++)
      for (let i = 0; i < f.size[0]; i++) {
        const x = f.low_m[0] + (i + 0.5) * f.cell_m[0], z = f.low_m[1] + (k + 0.5) * f.cell_m[1];
        if (regions.some(b => x > b[0] && x < b[3] && z > b[2] && z < b[5])) ground[k * f.size[0] + i] = 1;
      }
    /* Times at which nothing has changed to the eye share a picture: a hundredth of the cells may differ by more than a
     * hundredth of the scale. */
    const cells = f.kinds.map((kinds, i) => [pictures.bytes(kinds), pictures.bytes(f.values[i].bytes)]), spans = [];
    const same = ([kinds, values], [others, also]) => kinds.filter((kind, c) => kind !== others[c] || Math.abs(values[c] - also[c]) > 2.54).length < 0.01 * kinds.length;
    cells.forEach((cell, i) => {
      const last = spans[spans.length - 1];
      if (last && same(cells[last[0]], cell)) last[1] = i;
      else spans.push([i, i]);
    });
    spans.forEach(([i, until]) => {
      const time = duration(f.times_s[i]) + (until > i ? ` to ${duration(f.times_s[until])}, unchanged` : '');
      map(by('times'), time, time, {
        size: f.size, spacing: f.cell_m[0], value: pictures.field(f.values[i]), kinds: cells[i][0], low: 0, high: high,
        palette: wet ? 'saturation' : 'water', ground: ground, hatch: !wet, most: spans.length > 2 ? 340 : 520, axes: 'x across, z up',
        unit: {factor: factor, name: name}});
    });
    if (f.times_s.length < 3) note(by('frames'), 'The run stored few times: output.interval in its scene sets how often.');
    note(by('frames'), wet ? 'Saturation: the fraction of the pore volume that is full of water.' :
      `Pressure of the water${regions.length > 0 ? '; hatched: water in soil, sand-coloured: soil without water' : ''}, grey: walls.`);
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

  /* k of cubes cut from the sample, by their void ratio alone: ln k is taken as linear in it. */
  function sampleSize() {
    const q = model && model.quality, slope = result && Math.abs(result.dlnk_dvoid_ratio), k = 100 * (result && result.k_m_per_s), m = of('model');
    if (!q || !q.window || !known(slope) || !(k > 0)) return;
    const sides = q.window.map((w, i) => [1e3 * w, 1.96 * slope * q.void_ratio_deviation[i], q.windows[i]]).filter(r => r[2] > 1 && r[1] > 0 && r[1] < 2.5);
    if (sides.length < 2) return;
    chart(by('spacings'), 'k against the size of the sample', 'Side of a cube cut from the sample (mm)', 'k (cm/s)',
          [{name: 'k of the sample, and the range of 95 % of the cubes, by their void ratio', dots: true, points: sides.map(r => [r[0], k]),
            low: sides.map(r => k * Math.exp(-r[1])), high: sides.map(r => k * Math.exp(r[1]))}],
          {logx: true, dygraph: {logscale: true, valueRange: [0.8 * k * Math.exp(-sides[0][1]), 1.25 * k * Math.exp(sides[0][1])]},
           lines: [{y: k, name: ''}]});
  }

  /* ---- analyses ---- */
  /* A chart as analyze/chart.h describes it. */
  function described(parent, c) {
    const dashes = [null, [7, 3], [2, 3], [9, 3, 2, 3], [4, 6]], label = text => text.replace('^2', '²').replace('^3', '³');
    const series = c.series.map(s => ({name: s.name, dots: s.dots, colour: s.colour < 0 ? '--soft' : s.colour, dash: dashes[s.dash % 5],
                                       points: s.points.map(p => [p[0], p[1]]), low: s.points.map(p => p[2]), high: s.points.map(p => p[3])}));
    chart(parent, c.title, c.x, label(c.y), series, {logx: / x/.test(c.axes), dygraph: {logscale: /y$/.test(c.axes), includeZero: c.axes === 'zero'}});
  }

  function velocities(parent) {
    const runs = data.pdf.runs, scale = data.runs.length === 1 ? rescale : 1;
    const [factor, unit] = speedUnit(Math.max(...runs.map(r => r.pore_mean_m_per_s * r.normalised_velocity_max)));
    const rows = [['Mean in the pores', r => number(factor * scale * r.pore_mean_m_per_s) + ' ' + unit],
                  ['Fastest over the mean', r => number(r.normalised_velocity_max)],
                  ['Flowing backwards', r => percent(r.backward_fraction)], ['Tortuosity (mean speed over mean velocity)', r => number(r.tortuosity)],
                  ['Standard deviation over the mean', r => number(r.standard_deviation)]];
    table(add(parent, 'div', {class: 'wide'}), rows.map(([name, f]) => [name, ...runs.map(f)]), undefined,
          runs.length > 1 ? ['', ...runs.map(r => r.name)] : undefined);
  }

  function sections() {
    data.sections.forEach(s => {
      const asked = ['dispersion', 'breakthrough', 'film'].includes(s.name);
      const section = add(by(asked ? 'solute' : 'analyses'), 'section', {id: s.name}, add(null, 'h2', {}, s.heading));
      const charts = s.charts || [], of = place => charts.filter(c => c.place === place);
      if (charts.length > 0) {
        const box = add(section, 'div', {class: 'charts'});
        of('open').forEach(c => described(box, c));
        if (s.name === 'pdf') velocities(section);
        const more = of('folded'), fold = more.length > 0 && add(section, 'details', {},
          add(null, 'summary', {}, `${more.length} more: ${more.map(c => c.title.toLowerCase()).join(', ')}`), add(null, 'div', {class: 'charts'}));
        if (fold) fold.addEventListener('toggle', () => more.splice(0).forEach(c => described(fold.lastChild, c))); /* without width before it opens */
      }
      if (s.svg) {
        const figure = add(section, 'figure');
        add(figure, 'img', {class: 'still', src: 'data:image/svg+xml;base64,' + s.svg, alt: s.heading});
        tools(figure, ['Save SVG', () => save(s.name + '.svg', 'data:image/svg+xml;base64,' + s.svg)]);
      }
      note(section, s.caption);
      if (s.name !== 'history') add(add(section, 'details', {}, add(null, 'summary', {}, 'Numbers')), 'pre', {}, s.summary);
    });
    if (result && result.k_m_per_s === 0)
      add(by('analyses'), 'section', {id: 'blocked'}, add(null, 'h2', {}, 'Pore velocity'),
          add(null, 'p', {}, 'No pore leads through the model along the force: the water is at rest, and there is no velocity to show.'));
  }

  /* ---- specimen, soil, methods, provenance ---- */
  function soil() {
    const m = first.micro, a = m && m.attributes;
    if (!m) return;
    by('soil-text').append(`${percent(a.sites)} of the lattice points are soil of porosity ${number(a.porosity, 2)} and permeability ` +
      `${number(a.permeability)} m² (geometric mean). ${percent(a.flux_share)} of the flux goes through it, and its drag takes ` +
      `${percent(a.dlnk_dlnk_micro)} of the power that drives the flow: 10 % more permeability of the soil is ` +
      `${number(10 * a.dlnk_dlnk_micro, 2)} % more k.`);
    if (!m.factor || m.factor.length < 2) return;
    const against = (title, label, name, values) => chart(by('soil-chart'), title, 'Permeability of the soil (m²)', label,
      [{name: name, points: zip(m.factor.map(f => f * a.permeability), values.map(v => 100 * v))}], {logx: true, dygraph: {includeZero: true}});
    against('k by the permeability of the soil', 'k (cm/s)', 'k', m.k);
    against('Flux through soil', 'Fraction of the flux (%)', 'flux through soil', m.flux_share);
  }

  function specimen() {
    const state = data.model.state;
    by('specimen-note').append({none: '', found: '',
                                changed: `The model file ${run.model_path} is not the one that was run: it was changed or replaced since.`,
                                missing: `The model file ${run.model_path} could not be read when this page was made.`}[state]);
    if (!model) return;
    const m = of('model'), c = of('calibration'), count = run.size, walls = data.model.void_ratio_walls, um = v => known(v) && size(v);
    const within = known(walls) && Math.abs(walls - m.void_ratio) > 1e-6;
    table(by('facts'), [
      ['Model file', model.path.replace(/.*\//, '')], ['Voxel', m.spacing && um(m.spacing[2])], ['Voxel of the scan', um(m.voxel_scanned)],
      ['Lattice of the flow', count && `${count.join(' × ')} points of ${size(run.spacing[0])}`],
      ['Void ratio, measured on the specimen', number(m.void_ratio_measured)],
      [!within ? 'Void ratio of the model' : data.model.rule === 'labels' ? 'Void ratio by voxels of the smoothed labels' :
        'Void ratio of the model, by voxels', number(m.void_ratio)],
      within && ['Void ratio within the smooth walls, which the flow meets', number(walls)], ['Porosity', number(m.porosity)],
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
      chart(by('sizes'), 'Pore widths', 'Width of the pore (µm)', 'Volume of the pores (%)',
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

  function provenance() {
    const value = v => (Array.isArray(v) ? v.map(short).join(', ') : typeof v === 'number' ? String(Number(v.toPrecision(8))) :
      v === null ? 'none' : v);
    [...data.runs, ...data.models, ...data.solutes].forEach(file => {
      const fold = add(by('provenance'), 'details', {}, add(null, 'summary', {}, file.name + ' ', add(null, 'span', {class: 'path'}, file.path)));
      const p = file.provenance || {attributes: {}}, box = add(fold, 'div', {class: 'wide'});
      const inputs = (p.input_files || []).map((name, i) => [`input, XXH3 ${p.input_hashes[i]}`, name]);
      table(box, [...Object.entries(p.attributes), ...inputs].map(([k, v]) => [k, value(v)]));
      if (file.run) table(box, Object.entries(file.run.attributes).map(([k, v]) => [k, value(v)]), 'Run');
      if (file.effects && file.effects.name) {
        const e = file.effects, on = e.name.map((name, i) => e.state[i] === 'on' && [name, e.reason[i], e.model[i] + (e.citation[i] ? ` (${e.citation[i]})` : '')]);
        table(box, on, 'Effects that are on', ['', 'Why', 'Model']);
      }
      if (file.ledger) table(box, Object.entries(file.ledger.attributes).map(([k, v]) => [k.replace(/_/g, ' '), value(v)]), 'Balance (SI units, or fractions)');
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
    ['figure:empty, .charts:empty, .note:empty, #scanner:empty, p:empty', '.pair > div:empty'].forEach(empty => document.querySelectorAll(empty).forEach(e => e.remove()));
    const names = {...Object.fromEntries(data.sections.map(s => [s.name, s.contents])),
                   blocked: 'Pore velocity', frames: 'In time', soil: 'Soil', scan: 'Scan'};
    document.querySelectorAll('main section').forEach(s => {
      if (s.id === 'headline') return;
      if (!s.querySelector('canvas, table, img, p, .plot, .note, details > :nth-child(2)')) s.remove();
      else add(by('nav'), 'a', {href: '#' + s.id}, names[s.id] || s.querySelector('h2').textContent);
    });
  }

  header();
  if (solutes.length > 0) answerOfSolute();
  if (data.headline) answerOfHeadline();
  if (result) answerOfK();
  asked(by('asked'));
  others(by('others'));
  [scan, frames, flow, levels, sampleSize, sections, soil, specimen, methods, provenance, contents].forEach(f => f());

  start();
})();
