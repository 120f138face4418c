/* Draws the report's curves (dygraphs) and its three-dimensional view (three.js) from the JSON in the page.
 * Without either library the still pictures stay. */
(function () {
  'use strict';
  const read = id => {
    const element = document.getElementById(id);
    return element ? JSON.parse(element.textContent) : null;
  };
  const data = read('data');
  const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const dark = window.matchMedia('(prefers-color-scheme: dark)').matches && !window.matchMedia('print').matches;
  /* Okabe, Ito (2008); on dark paper the light ones first. */
  const okabeIto = dark ? ['#56B4E9', '#E69F00', '#009E73', '#CC79A7', '#F0E442', '#D55E00', '#999999'] : ['#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00', '#56B4E9', '#999999'];
  const colour = i => okabeIto[i % okabeIto.length];
  const element = (parent, tag, className, text) => {
    const e = document.createElement(tag);
    if (className) e.className = className;
    if (text !== undefined) e.textContent = text;
    parent.appendChild(e);
    return e;
  };
  const short = v => {
    if (v === null || Number.isNaN(v)) return '';
    const n = Number(v.toPrecision(5)), size = Math.abs(n);
    return n !== 0 && (size < 1e-3 || size >= 1e6) ? n.toExponential() : n.toString();
  };
  const save = (name, href) => {
    const a = document.createElement('a');
    a.download = name;
    a.href = href;
    a.click();
  };

  /* series: {name, points: [[x, y], ...] (y null: a gap), dots, step, dash, colour} */
  function chart(parent, title, xlabel, ylabel, series, options) {
    series = series.filter(s => s.points.length > 0);
    if (series.length === 0) return;
    const box = element(parent, 'div', 'chart');
    element(box, 'h3', '', title);
    const plot = element(box, 'div', 'plot');
    const legend = element(box, 'div', 'legend');
    const names = new Set(['x']);
    series.forEach((s, i) => {
      s.colour = s.colour || colour(i);
      while (names.has(s.name)) s.name += ' \u2032';
      names.add(s.name);
    });
    const points = [];
    series.forEach((s, i) => s.points.forEach(p => points.push([p[0], i, p[1]])));
    points.sort((a, b) => a[0] - b[0]);
    const rows = [];
    for (const [x, i, y] of points) {
      let row = rows[rows.length - 1];
      if (!row || row[0] !== x || row[i + 1] !== null) {
        row = [x].concat(series.map(() => null));
        rows.push(row);
      }
      row[i + 1] = y === null ? NaN : y;
    }
    const perSeries = {};
    series.forEach(s => {
      perSeries[s.name] = {color: s.colour, strokeWidth: s.dots ? 0 : 2, drawPoints: !!s.dots, pointSize: 4,
                           highlightCircleSize: s.dots ? 6 : 3, stepPlot: !!s.step,
                           strokePattern: s.dash || null};
    });
    const show = (x, row) => {
      legend.textContent = x === undefined ? '' : xlabel.replace(/ \(.*/, '') + ' ' + short(x) + '  ';
      series.forEach((s, i) => {
        const item = element(legend, 'span', 'item');
        const mark = element(item, 'i', s.dots ? 'dots' : '');
        mark.style[s.dots ? 'background' : 'borderTopColor'] = s.colour;
        if (s.dash) mark.style.borderTopStyle = 'dashed';
        const value = row && row[i + 1] !== null ? ': ' + short(row[i + 1]) : '';
        item.appendChild(document.createTextNode(s.name + value));
      });
    };
    const graph = new Dygraph(plot, rows, Object.assign({
      labels: ['x'].concat(series.map(s => s.name)), series: perSeries, connectSeparatedPoints: true,
      xlabel: xlabel, ylabel: ylabel, legend: 'never', gridLineColor: css('--line'), axisLineColor: css('--soft'),
      axisLabelWidth: 62, xRangePad: 8, yRangePad: 12, labelsKMB: false, digitsAfterDecimal: 4,
      axes: {y: {axisLabelFormatter: v => short(v)}, x: {axisLabelFormatter: v => short(v)}},
      highlightCallback: (event, x, selected, index) => show(x, rows[index]), unhighlightCallback: () => show()
    }, options || {}));
    show();
    const tools = element(box, 'div', 'tools');
    element(tools, 'button', '', 'Whole range').onclick = () => graph.resetZoom();
    element(tools, 'button', '', 'Save CSV').onclick = () => {
      const quote = t => '"' + t.replace(/"/g, '""') + '"';
      const lines = [[xlabel].concat(series.map(s => s.name + ', ' + ylabel)).map(quote).join(',')];
      rows.forEach(r => lines.push(r.map(v => (v === null || Number.isNaN(v) ? '' : v)).join(',')));
      save(title + '.csv', 'data:text/csv;charset=utf-8,' + encodeURIComponent(lines.join('\n') + '\n'));
    };
  }

  const zip = (x, y) => x.map((v, i) => [v, y[i]]);
  /* A density as steps: its last edge closes it; empty bins are gaps on a logarithmic axis. */
  const steps = (pdf, scale, offset, log) => {
    const points = pdf.density.map((d, i) => [pdf.bin_edges[i] * scale - offset, log && d <= 0 ? null : d / scale]);
    points.push([pdf.bin_edges[pdf.density.length] * scale - offset, points[points.length - 1][1]]);
    return points;
  };
  const sample = (f, low, high, n) => {
    const points = [];
    for (let i = 0; i <= n; i++) {
      const s = low + (high - low) * i / n;
      points.push([s, f(s)]);
    }
    return points;
  };

  const draw = {
    darcy(parent, darcy) {
      const series = [];
      darcy.groups.forEach((g, i) => {
        const most = Math.max.apply(null, g.runs.map(r => r.hydraulic_gradient));
        const k = g.k_m_per_s, f = g.forchheimer;
        if (k !== null) {
          const b = f && f.called_for ? f.b_s2_per_m2 : 0;
          const v = x => 100 * (b > 0 ? 2 * x / (1 / k + Math.sqrt(1 / (k * k) + 4 * b * x)) : k * x);
          series.push({name: g.name + ', fit', points: sample(v, 0, 1.05 * most, b > 0 ? 60 : 1), colour: colour(i)});
        }
        series.push({name: g.name, dots: true, colour: colour(i),
                     points: g.runs.map(r => [r.hydraulic_gradient, 100 * r.darcy_velocity_m_per_s])});
      });
      chart(parent, 'Darcy velocity', 'Hydraulic gradient (-)', 'Darcy velocity (cm/s)', series, {includeZero: true});
    },
    history(parent, history) {
      const runs = history.runs;
      const iterations = runs[0].stationary, abscissa = r => r.time_s || r.iteration;
      const end = Math.max.apply(null, runs.map(r => r.end_time_s || 0));
      const scale = end < 0.1 && !iterations ? 1e3 : 1;
      const time = iterations ? 'Iteration' : end < 0.1 ? 'Time (ms)' : 'Time (s)';
      const against = (name, pick) => runs.map(r => ({name: r.name, points: pick(r) || []}));
      const series = (r, values, f) => values && abscissa(r).map((t, i) => [t * scale, values[i] === null ? null : f(values[i])]);
      const varies = values => values && values.some(v => v !== values[0]);
      chart(parent, 'Darcy velocity', time, 'Darcy velocity (cm/s)',
            against('', r => series(r, r.darcy_velocity_series_m_per_s, v => 100 * v)));
      chart(parent, 'Maximum density', time, 'Above reference (%)',
            against('', r => !r.stationary && varies(r.density_max_series_kg_per_m3) &&
                             series(r, r.density_max_series_kg_per_m3,
                                    v => 100 * (v / r.density_reference_kg_per_m3 - 1))));
      chart(parent, 'Density at the end', 'Above reference (%)', 'Probability density (1/%)',
            runs.map(r => ({name: r.name, step: true,
                            points: r.density_histogram ? steps(r.density_histogram, 100, 100, false) : []})), {includeZero: true});
      // The works of the energy budget stand in its table.
      const extras = [];
      Object.keys(runs[0].columns).filter(name => !name.startsWith('work_')).forEach(name => {
        const column = runs[0].columns[name], list = [];
        runs.forEach(r => r.columns[name] && r.columns[name].series.forEach((values, d, all) => (
          all.length > 1 && d === 1 && r.dimensions === 2) || values.every(v => v === null) || list.push({
          name: r.name + (r.columns[name].series.length > 1 ? ' ' + 'xyz'[d] : ''),
          points: series(r, values, v => v)})));
        if (list.length === 0) return; // a level where there is none
        const all = [].concat.apply([], list.map(s => s.points.map(p => p[1]))).filter(v => v !== null);
        const least = Math.min.apply(null, all), most = Math.max.apply(null, all);
        const words = name.replace(/_/g, ' '), title = words[0].toUpperCase() + words.slice(1);
        extras.push([title, time, title + ' (' + (column.unit === '1' ? '-' : column.unit || '-') + ')', list,
                     least > 0 && most > 1e3 * least ? {logscale: true} : {}]);
      });
      // More than a screen or two of them wait behind a fold.
      let into = parent;
      if (extras.length > 4) {
        const fold = document.createElement('details');
        parent.after(fold);
        element(fold, 'summary', '', extras.length + ' more: ' + extras.map(e => e[0].toLowerCase()).join(', '));
        into = element(fold, 'div', 'charts');
      }
      extras.forEach(e => chart(into, ...e));
    },
    pdf(parent, pdf) {
      chart(parent, 'Velocity along the force', 'Velocity (mm/s)', 'Probability density (s/mm)',
            pdf.runs.map(r => ({name: r.name, step: true, points: steps(r.pdf_m_per_s, 1e3, 0, true)})), {logscale: true});
      let least = 1;
      pdf.runs.forEach(r => r.pdf.density.forEach(d => { if (d > 0 && d < least) least = d; }));
      const dashes = [null, [7, 3], [2, 3], [7, 3, 2, 3]];
      const references = pdf.references.map((r, i) => ({
        name: r.name === 'power-exponential' ? r.name + ', \u03b3 = ' + pdf.runs[0].power_exponential.gamma.toFixed(2) : r.name,
        points: zip(r.normalised_velocity, r.density).filter(q => q[1] > 0.5 * least), dash: dashes[i], colour: css('--soft')}));
      chart(parent, 'Velocity over the pore mean', 'Velocity / pore mean (-)', 'Probability density (-)',
            pdf.runs.map(r => ({name: r.name, step: true, points: steps(r.pdf, 1, 0, true)})).concat(references), {logscale: true});
    },
    converge(parent, converge) {
      const against = [], cost = [];
      converge.series.forEach((s, i) => {
        const name = s.method + (s.wall ? ', ' + s.wall + ' walls' : '');
        against.push({name: name, dots: true, colour: colour(i),
                      points: s.runs.map(r => [1e6 * r.spacing_m, 100 * r.k_m_per_s])});
        if (s.k_m_per_s === null) return;
        const widest = Math.max.apply(null, s.runs.map(r => r.spacing_m));
        const perArea = s.k_cm_per_s / s.intrinsic_permeability_m2;
        const fit = h => perArea * (s.intrinsic_permeability_m2 + s.fit.slope_m2_per_m_to_the_order * Math.pow(h, s.fit.order));
        if (s.extrapolated)
          against.push({name: name + ', fit', colour: colour(i), points: sample(h => fit(h * 1e-6), 0, 1e6 * widest, 80)});
        cost.push({name: name, colour: colour(i), points: s.runs.filter(r => r.wall_time_s > 0).map(
          r => [r.wall_time_s, Math.max(1e-6, 100 * Math.abs(r.deviation_from_extrapolated))])});
      });
      chart(parent, 'k against spacing', 'Spacing (\u00b5m)', 'k (cm/s)', against);
      chart(parent, 'Accuracy against time', 'Wall-clock time (s)', 'Deviation from the extrapolated k (%)', cost,
            {axes: {x: {logscale: true, axisLabelFormatter: v => short(v)}, y: {axisLabelFormatter: v => short(v)}},
             logscale: true});
    },
    calibration(parent, c) {
      const high = c.void_ratio_shown;
      const curve = values => (values ? zip(c.threshold, values).filter(p => p[1] !== null && p[1] < high) : []);
      const model = curve(c.void_ratio), last = model[model.length - 1];
      const series = [{name: 'model', points: model}, {name: 'scan', points: curve(c.void_ratio_original)}];
      const line = (name, points) => series.push({name: name, points: points, dash: [7, 3], colour: css('--soft')});
      if (c.void_ratio_measured !== null)
        line('measured void ratio', [model[0], last].map(p => [p[0], c.void_ratio_measured]));
      if (c.threshold_chosen !== null) line('threshold', [[c.threshold_chosen, 0], [c.threshold_chosen, last[1]]]);
      chart(parent, 'Calibration', 'Grey threshold', 'Void ratio (-)', series, {includeZero: true});
      const share = values => {
        const most = Math.max.apply(null, values || [1]);
        return values ? zip(c.threshold, values.map(v => v / most)) : [];
      };
      chart(parent, 'Grey values', 'Grey value', 'Voxels (share of the highest)',
            [{name: 'model', points: share(c.histogram)}, {name: 'scan', points: share(c.histogram_original)}],
            {includeZero: true});
    }
  };

  /* A map is complete in itself: saved as it stands. */
  document.querySelectorAll('svg.map').forEach((map, i) => {
    const tools = document.createElement('div');
    tools.className = 'tools';
    map.after(tools);
    element(tools, 'button', '', 'Save SVG').onclick = () =>
      save('map-' + (i + 1) + '.svg', 'data:image/svg+xml;charset=utf-8,' + encodeURIComponent(map.outerHTML));
  });
  if (window.Dygraph) {
    document.documentElement.classList.add('live');
    document.querySelectorAll('.charts').forEach(parent => {
      const part = parent.dataset.part;
      if (data[part]) draw[part](parent, data[part]);
    });
  }
  /* Charts behind a fold have no width until it opens. */
  document.querySelectorAll('details').forEach(d => d.addEventListener('toggle', () => window.dispatchEvent(new Event('resize'))));
  document.querySelectorAll('img.still').forEach(still => {
    const tools = element(still.parentNode, 'div', 'tools');
    element(tools, 'button', '', 'Save SVG').onclick = () => save(still.dataset.name + '.svg', still.src);
  });

  /* ---- three dimensions ---- */

  const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));

  /* Surface nets (Gibson 1998) of the field f = 1/2, closed by an empty border. Axes x y z of the
   * model; a vertex for each cell that the surface crosses, a quad for each edge. */
  function surface(f, size) {
    const [nx, ny, nz] = size.map(n => n + 2);
    const at = (x, y, z) => (z * ny + y) * nx + x;
    const g = new Float32Array(nx * ny * nz);
    for (let z = 0; z < size[2]; z++)
      for (let y = 0; y < size[1]; y++)
        for (let x = 0; x < size[0]; x++) g[at(x + 1, y + 1, z + 1)] = f[(z * size[1] + y) * size[0] + x] - 0.5;
    for (let i = 0; i < g.length; i++) if (g[i] === 0) g[i] = -1e-4;
    for (let z = 0; z < nz; z++)
      for (let y = 0; y < ny; y++)
        for (let x = 0; x < nx; x++)
          if (x === 0 || y === 0 || z === 0 || x === nx - 1 || y === ny - 1 || z === nz - 1) g[at(x, y, z)] = -0.5;
    const vertex = new Int32Array(g.length).fill(-1), positions = [], indices = [];
    const corner = [0, 1, nx, nx + 1, nx * ny, nx * ny + 1, nx * ny + nx, nx * ny + nx + 1];
    for (let z = 0; z + 1 < nz; z++)
      for (let y = 0; y + 1 < ny; y++)
        for (let x = 0; x + 1 < nx; x++) {
          const base = at(x, y, z);
          let mask = 0;
          for (let c = 0; c < 8; c++) if (g[base + corner[c]] > 0) mask |= 1 << c;
          if (mask === 0 || mask === 255) continue;
          let px = 0, py = 0, pz = 0, n = 0;
          for (let a = 0; a < 8; a++)
            for (let d = 1; d < 8; d <<= 1) {
              if (a & d) continue;
              const ga = g[base + corner[a]], gb = g[base + corner[a | d]];
              if ((ga > 0) === (gb > 0)) continue;
              const t = ga / (ga - gb);
              px += (a & 1 ? 1 : 0) + (d === 1 ? t : 0);
              py += (a & 2 ? 1 : 0) + (d === 2 ? t : 0);
              pz += (a & 4 ? 1 : 0) + (d === 4 ? t : 0);
              n++;
            }
          vertex[base] = positions.length / 3;
          positions.push(x + px / n - 0.5, y + py / n - 0.5, z + pz / n - 0.5);
        }
    const step = [1, nx, nx * ny];
    for (let z = 1; z + 1 < nz; z++)
      for (let y = 1; y + 1 < ny; y++)
        for (let x = 1; x + 1 < nx; x++) {
          const base = at(x, y, z);
          for (let d = 0; d < 3; d++) {
            const inside = g[base] > 0;
            if (inside === (g[base + step[d]] > 0)) continue;
            const u = step[(d + 1) % 3], v = step[(d + 2) % 3];
            const q = [vertex[base], vertex[base - u], vertex[base - u - v], vertex[base - v]];
            if (!inside) q.reverse();
            indices.push(q[0], q[1], q[2], q[0], q[2], q[3]);
          }
          /* Edges that leave the border are those of the layer below: they start at 0. */
        }
    for (let d = 0; d < 3; d++) { /* from the border into the first layer */
      const a = (d + 1) % 3, b = (d + 2) % 3, n = [nx, ny, nz];
      for (let i = 1; i + 1 < n[a]; i++)
        for (let j = 1; j + 1 < n[b]; j++) {
          const base = i * step[a] + j * step[b];
          if (!(g[base + step[d]] > 0)) continue;
          const q = [vertex[base], vertex[base - step[a]], vertex[base - step[a] - step[b]], vertex[base - step[b]]].reverse();
          indices.push(q[0], q[1], q[2], q[0], q[2], q[3]);
        }
    }
    return {positions: positions, indices: indices};
  }

  /* One pass of (1, 4, 1)/6 along each axis takes the stairs off binary sites. */
  function smooth(f, size) {
    const step = [1, size[0], size[0] * size[1]];
    for (let d = 0; d < 3; d++) {
      const old = f.slice();
      for (let i = 0; i < f.length; i++) {
        const k = Math.floor(i / step[d]) % size[d];
        const a = k > 0 ? old[i - step[d]] : old[i], b = k + 1 < size[d] ? old[i + step[d]] : old[i];
        f[i] = (a + 4 * old[i] + b) / 6;
      }
    }
  }

  /* Five-sided tubes along the streamlines; `stops` colour by speed. */
  function tubes(flow, radius) {
    const words = new Uint16Array(bytes(flow.points).buffer);
    const stops = ['#fdb42f', '#ed7953', '#cc4778', '#9c179e', '#0d0887'].map(c => new THREE.Color(c));
    const sides = 5, positions = [], colours = [], indices = [], tint = new THREE.Color();
    const up = new THREE.Vector3(), side = new THREE.Vector3(), along = new THREE.Vector3();
    let start = 0;
    for (const count of flow.lines) {
      const point = i => {
        const k = 4 * (start + Math.min(Math.max(i, 0), count - 1));
        return new THREE.Vector3(words[k] / 500, words[k + 1] / 500, words[k + 2] / 500);
      };
      up.set(0.3, 0.5, 0.8);
      for (let i = 0; i < count; i++) {
        along.copy(point(i + 1)).sub(point(i - 1)).normalize();
        side.crossVectors(along, up).normalize();
        up.crossVectors(side, along).normalize();
        const s = 4 * Math.min(words[4 * (start + i) + 3] / 65535, 1), j = Math.min(Math.floor(s), 3);
        tint.copy(stops[j]).lerp(stops[j + 1], s - j);
        const p = point(i), first = positions.length / 3;
        for (let k = 0; k < sides; k++) {
          const angle = 2 * Math.PI * k / sides, c = radius * Math.cos(angle), d = radius * Math.sin(angle);
          positions.push(p.x + c * side.x + d * up.x, p.y + c * side.y + d * up.y, p.z + c * side.z + d * up.z);
          colours.push(tint.r, tint.g, tint.b);
          const next = (k + 1) % sides;
          if (i + 1 < count)
            indices.push(first + k, first + next, first + sides + k, first + next, first + sides + next, first + sides + k);
        }
      }
      start += count;
    }
    return {positions: positions, colours: colours, indices: indices};
  }

  function mesh(shape, material) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.Float32BufferAttribute(shape.positions, 3));
    if (shape.colours) geometry.setAttribute('color', new THREE.Float32BufferAttribute(shape.colours, 3));
    geometry.setIndex(shape.indices);
    geometry.computeVertexNormals();
    return new THREE.Mesh(geometry, material);
  }

  function view(flow) {
    const box = document.getElementById('view');
    const renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
    renderer.localClippingEnabled = true;
    renderer.setPixelRatio(window.devicePixelRatio || 1);
    const size = flow.size, packed = bytes(flow.grains);
    const field = new Float32Array(size[0] * size[1] * size[2]);
    for (let i = 0; i < field.length; i++) field[i] = (packed[i >> 1] >> (i % 2 * 4) & 15) / 15;
    smooth(field, size);
    const scene = new THREE.Scene(), group = new THREE.Group();
    const plane = new THREE.Plane(new THREE.Vector3(0, 0, -1), 0);
    group.add(mesh(surface(field, size), new THREE.MeshStandardMaterial(
      {color: 0xd6cec0, roughness: 0.9, metalness: 0, side: THREE.DoubleSide, clippingPlanes: [plane]})));
    const big = Math.max(size[0], size[1], size[2]);
    group.add(mesh(tubes(flow, 0.004 * big), new THREE.MeshBasicMaterial({vertexColors: THREE.VertexColors})));
    group.position.set(-size[0] / 2, -size[1] / 2, -size[2] / 2);
    const turned = new THREE.Group(); /* z of the model points up, y away from the eye */
    turned.add(group);
    turned.rotation.x = -Math.PI / 2;
    const frame = new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxGeometry(size[0], size[1], size[2])),
                                         new THREE.LineBasicMaterial({color: 0x888888}));
    turned.add(frame);
    scene.add(turned);
    scene.add(new THREE.HemisphereLight(0xffffff, 0x777788, 0.75));
    const sun = new THREE.DirectionalLight(0xffffff, 0.55);
    sun.position.set(-1, 2, 1.5);
    scene.add(sun);
    const camera = new THREE.PerspectiveCamera(35, 1, 0.1, 40 * big);
    camera.position.set(-1.35 * big, 1.05 * big, 2.3 * big);
    const controls = new THREE.OrbitControls(camera, renderer.domElement);
    const paint = () => {
      scene.background = new THREE.Color(css('--card'));
      renderer.render(scene, camera);
    };
    const fit = () => {
      renderer.setSize(box.clientWidth, box.clientHeight);
      camera.aspect = box.clientWidth / box.clientHeight;
      camera.updateProjectionMatrix();
      paint();
    };
    const label = document.createElement('label');
    label.textContent = 'Grains ';
    const slider = element(label, 'input');
    slider.type = 'range';
    slider.min = 0;
    slider.max = 100;
    slider.value = 55;
    const cut = () => {
      plane.constant = size[1] * (slider.value / 100 - 0.5);
      paint();
    };
    slider.oninput = cut;
    box.textContent = '';
    box.appendChild(renderer.domElement);
    box.appendChild(label);
    controls.addEventListener('change', paint);
    window.addEventListener('resize', fit);
    fit();
    controls.update();
    cut();
    const gl = renderer.getContext(), wide = gl.drawingBufferWidth, pixels = new Uint8Array(4 * wide);
    gl.readPixels(0, gl.drawingBufferHeight >> 1, wide, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let drawn = 0; /* of the middle row, those that differ from its first */
    for (let i = 4; i < pixels.length; i += 4) if (pixels[i] !== pixels[0] || pixels[i + 1] !== pixels[1]) drawn++;
    box.dataset.drawn = drawn;
  }

  const flow = read('flow-data');
  if (flow && window.THREE && THREE.OrbitControls) {
    try {
      view(flow);
    } catch (error) { /* no WebGL: the still picture stays */
      console.warn('no three-dimensional view: ' + error.message);
    }
  }
})();
