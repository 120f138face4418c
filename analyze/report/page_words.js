/* What the page says in sentences, from the numbers in its JSON: fill(data) adds it. It needs no document, so that tests
 * (tests/cli/page.py) read what readers read. */
const words = (function () {
  'use strict';
  const known = v => typeof v === 'number' && Number.isFinite(v);
  const digits = (v, n = 3) => (known(v) ? String(Number(v.toPrecision(n))) : 'unknown');
  const percent = share => (Math.abs(share) < 0.995 ? digits(100 * share, 2) : (100 * share).toFixed(0)) + ' %';
  const of = (file, group) => (file && file[group] ? file[group].attributes : {});
  const axes = 'xyz'.split('');

  /* ---- references, listed where a sentence cites them ---- */
  const REFERENCES = {
    morris: 'Morris JP, Fox PJ, Zhu Y (1997) J. Comput. Phys. 136, 214-226.',
    adami: 'Adami S, Hu XY, Adams NA (2012) J. Comput. Phys. 231, 7057-7075.',
    basa: 'Basa M, Quinlan NJ, Lastiwka M (2009) Int. J. Numer. Meth. Fluids 60, 1127-1148.',
    saomoto: 'Saomoto H, Matsushima T, Yamada Y, Hatano Y (2006) Development of digital Toyoura porous model and porous media flow simulation using SPH (in Japanese).',
    akbari: 'Akbari H (2014) Coastal Eng. 89, 1-19.',
    morimoto: 'Morimoto T, Asai M, Kasama K, Fujisawa K, Imoto Y (2015) J. JSCE Ser. A2 70, I_213-I_221 (in Japanese).',
    aavatsmark: 'Aavatsmark I, Barkve T, Boe O, Mannseth T (1996) J. Comput. Phys. 127, 2-14.',
    richards: 'Richards LA (1931) Physics 1, 318-333.',
    celia: 'Celia MA, Bouloutas ET, Zarba RL (1990) Water Resour. Res. 26, 1483-1496.',
    genuchten: 'van Genuchten MT (1980) Soil Sci. Soc. Am. J. 44, 892-898.',
    mualem: 'Mualem Y (1976) Water Resour. Res. 12, 513-522.',
    white: 'White KP (1997) Simulation 69, 323-334.',
    flegal: 'Flegal JM, Jones GL (2010) Ann. Stat. 38, 1034-1070.',
    otsu: 'Otsu N (1979) IEEE Trans. Syst. Man Cybern. 9, 62-66.',
    celik: 'Celik IB, Ghia U, Roache PJ, Freitas CJ (2008) J. Fluids Eng. 130, 078001.',
    hoeting: 'Hoeting JA, Madigan D, Raftery AE, Volinsky CT (1999) Stat. Sci. 14, 382-417.',
    brenner: 'Brenner H (1980) Phil. Trans. R. Soc. Lond. A 297, 81-133.',
    bijeljic: 'Bijeljic B, Muggeridge AH, Blunt MJ (2004) Water Resour. Res. 40, W11501.'
  };

  /* ---- methods: a paragraph for a paper ---- */
  /* How the grey threshold was chosen. Options may be abbreviated, as getopt_long allows. */
  function ruleOf(model) {
    const p = of(model, 'provenance'), given = / --thre\w*[ =]+(\S+)/.exec(p.command_line || '');
    if (p.program !== 'ct2model') return '';
    if (of(model, 'calibration').segmented > 0) return 'labels';
    if (given && given[1] !== 'auto') return given[1] === 'otsu' ? 'otsu' : 'given';
    return known(of(model, 'model').void_ratio_measured) ? 'matched' : '';
  }

  /* Along which axes the sample is its own mirror image. The mirrored sides of a model are those along x and y. */
  const mirrored = (run, m) => axes.filter((d, i) => m.mirror_axis === d || (m.sides === 'mirrored' && d !== 'z') || (run.mirrored || [])[i] > 0);

  function geometry(data, run, m) {
    const {state, rule} = data.model, along = mirrored(run, m), t = digits(m.threshold, 4), e = digits(m.void_ratio, 4), measured = m.void_ratio_measured;
    if (state === 'none') return '';
    if (state !== 'found')
      return ', from a model file that ' + (state === 'changed' ? 'was changed or replaced after the run' : 'could not be read when this page was made');
    if (of(data.models[0], 'provenance').program !== 'ct2model') return ', from a voxel model';
    const off = Math.abs(m.void_ratio / measured - 1) > 0.01;
    const how = {
      matched: ` whose grey threshold (${t}) was set so that the model has the void ratio measured on the specimen, ${digits(measured, 4)}` +
        (off ? ` (it has ${e})` : ''),
      otsu: ` at the grey threshold of Otsu's method [otsu], ${t}, which gives a void ratio of ${e}`,
      given: ` at a given grey threshold of ${t}, which gives a void ratio of ${e}`,
      labels: ` that was segmented before; the model has a void ratio of ${e}`
    }[rule] || `; it has a void ratio of ${e}`;
    const test = rule === '' || rule === 'matched' ? '' :
      known(measured) ? `; ${digits(measured, 4)} was measured on the specimen` : '; no measured void ratio was given';
    return ', made by ct2model from an image' + how + test +
      (along.length > 0 ? '; it is mirrored along ' + along.join(', ').replace(/, (.)$/, ' and $1') : '') + (m.sides === 'closed' ? '; its sides are walls' : '');
  }

  const METHODS = {
    isph: 'The unified Navier-Stokes and extended Darcy equations were integrated by stabilised incompressible smoothed particle ' +
      'hydrodynamics [morimoto] [akbari]. ',
    darcy: "Darcy's law, with Forchheimer's term where a soil has one, was solved for soil that stays full of water by multi-point finite " +
      'volumes on fixed points [aavatsmark]. ',
    richards: 'The equation of Richards for water in soil that is not full [richards] was solved in its mass-conserving form [celia] on ' +
      'fixed points, with the curves of van Genuchten [genuchten] and Mualem [mualem]. '
  };
  const KERNELS = {quintic: 'quintic spline', cubic: 'cubic spline', wendland: 'Wendland C2 kernel'};

  function solver(run) {
    if (run.method === 'stokes')
      return 'The steady creeping flow was solved with the smoothed particle hydrodynamics operators of [morris] on the lattice itself. ' +
        (run.reynolds > 0.1 ? `Inertia is left out, at a Reynolds number of ${digits(run.reynolds, 2)}. ` : '');
    if (run.method === 'wcsph') /* the quintic was the default of older runs */
      return `Weakly compressible smoothed particle hydrodynamics with a ${KERNELS[run.kernel || 'quintic'] || run.kernel} and the viscosity of ` +
        '[morris] was integrated in time. ';
    return METHODS[run.method] || '';
  }

  function walls(data, run) {
    const by = {distance: "the model's signed distances to the grain surface", fraction: 'found from the grain fraction of the voxels',
                faces: 'the faces of the voxels'}[data.model.walls];
    return {adami: 'Grain surfaces carry dummy velocities [adami]. ',
            subvoxel: 'No slip holds at the wall itself, by image velocities from the distance to it, after [basa]' + (by ? `; walls are ${by}. ` : '. '),
            frozen: 'Grains are frozen fluid particles after [saomoto], which widens every gap by one spacing. '}[run.wall] || '';
  }

  function outcome(data, run, result) {
    const from = (result.error_budget || {}).resolution_from || '', index = from[0] === 'g', l = data.runs[0].levels;
    const um = h => digits(1e6 * h, 4);
    let text = '';
    if (data.runs.some(r => r.run.attributes.method !== 'stokes'))
      text += 'The Darcy velocity was averaged after the start-up, whose end is given by the marginal standard error rule [white]; its error is ' +
        'from batch means [flegal]. ';
    text += data.sections.some(s => s.name === 'darcy') ? 'Permeability is the slope of the superficial velocity against the hydraulic gradient' :
      'Permeability is the superficial velocity over the hydraulic gradient';
    if (index && data.converge && data.converge.series.some(s => s.extrapolated)) text += ', extrapolated over the spacings of the runs';
    text += '; errors are 95 % half widths. ';
    if (index) text += 'The error of resolution is a grid convergence index [celik]. ';
    if (from[0] === 'l' && l && l.spacing.length > 1)
      text += `The error of resolution is that of the limit of ${l.spacing.length} lattices with spacings from ${um(l.spacing[0])} to ` +
        `${um(l.spacing[l.spacing.length - 1])} µm, averaged over the orders of convergence [hoeting]` +
        (run.method === 'stokes' ? '; the permeability is that limit. ' : '. ');
    return text;
  }

  function methods(data) {
    const first = data.runs[0], run = first.run.attributes, model = data.models[0], m = of(model, 'model'), c = of(model, 'calibration'), s = of(model, 'scanner');
    const [scale, unit] = run.spacing[0] > 1e-3 ? [1e3, 'mm'] : [1e6, 'µm'], length = h => digits(scale * h, 4), um = h => digits(1e6 * h, 4) + ' µm';
    /* Lattices with their own spacings fit the body in each direction separately. */
    const cubic = [1, 2].every(d => run.size[d] <= 1 || Math.abs(run.spacing[d] / run.spacing[0] - 1) < 5e-4);
    const closure = data.solutes.some(f => f.closure), walk = data.solutes.some(f => f.walk);
    const text = `Flow was computed with Tosui ${data.version} [tosui] on a lattice of ${run.size.join(' × ')} points of ` +
      `${(cubic ? run.spacing.slice(0, 1) : run.spacing).map(length).join(' × ')} ${unit}${geometry(data, run, m)}. ` +
      (data.model.rule === 'labels' && c.smoothing > 0 ?
        `Walls are drawn through the labels smoothed by a Gaussian with a standard deviation of ${um(c.smoothing)}` +
        (c.smoothing_even > 0 ? `, where they are even enough of ${um(c.smoothing_even)} without its second moment` : '') + ', at the volume of their pores. ' : '') +
      (s.removed > 0 ? `The scanner's blur, by the edges of the scan a Gaussian with a standard deviation of ${um(s.blur)}, was taken out of the surface. ` : '') +
      `The fluid had a density of ${digits(run.density, 6)} kg/m³ and a viscosity of ${digits(run.viscosity, 6)} Pa s. ` + solver(run) + walls(data, run) +
      (data.model.soil ? 'Soil with pores below the voxel is solved together with the open pores, as a porous medium with a drag of its own permeability. ' : '') +
      (data.runs.length > 1 ? `${data.runs.length} runs entered this page; lattice, model and fluid are the first's. ` : '') +
      (data.verdict.length > 0 ? outcome(data, run, data.verdict[0]) : '') +
      (first.tensor ? 'The tensor of permeability is from three flows, each driven along one of x, y and z. ' : '') +
      (data.solutes.length > 0 ? 'How a solute disperses in the flow was found ' +
        [closure && 'from the closure problem of its transport [brenner] on finite volumes', walk && 'by random walks [bijeljic]'].filter(t => t).join(', and ') + '. ' : '');
    const own = `Tosui ${data.version}, seepage through porous media from CT images by smoothed particle hydrodynamics (ct2model, sphsolve, analyze).`;
    const cited = [];
    const numbered = text.replace(/\[(\w+)\]/g, (_, key) => {
      if (!cited.includes(key)) cited.push(key);
      return `[${cited.indexOf(key) + 1}]`;
    });
    return {text: numbered, references: cited.map(key => REFERENCES[key] || own)};
  }

  /* ---- k: its class, another formula, and what its error does not count ---- */
  /* Lower bounds of k, m/s, of water: DIN 18130-1 (1998), table 1 (the test itself: ISO 17892-11); Casagrande, Fadum (1940), as drawn by
   * Terzaghi, Peck (1948). The last of each includes a negative k due to noise. */
  const DIN = [[1e-2, 'very strongly permeable'], [1e-4, 'strongly permeable'], [1e-6, 'permeable'], [1e-8, 'weakly permeable'],
               [-Infinity, 'very weakly permeable']];
  const CASAGRANDE = [[1e-6, 'good drainage'], [1e-8, 'poor drainage'], [-Infinity, 'practically impervious']];

  function classOf(classes, r) {
    const [low, high] = (known(r.k_relative_error) ? [r.k_low_m_per_s, r.k_high_m_per_s] : [r.k_m_per_s, r.k_m_per_s]).map(k => classes.find(c => k >= c[0])[1]);
    return low === high ? low : `${low} to ${high}`;
  }

  /* K = n^3 / (5 S^2) (Kozeny 1927; Carman 1937) from the porosity n and the grain surface S per bulk volume. Not with soil below the
   * voxel size, whose pores are in n but its grains not in S. */
  function formulas(data) {
    const m = of(data.models[0], 'model'), run = data.runs[0].run.attributes, e = m.void_ratio;
    const n = known(m.porosity) ? m.porosity : e / (1 + e), s = m.specific_surface;
    return n > 0 && n < 1 && s > 0 && !data.model.soil ? {kozeny_carman: 9.80665 * run.density / run.viscosity * n ** 3 / (5 * s * s)} : undefined;
  }

  /* The tensor of the runs of a result, else of runs of the same body. */
  function tensorOf(data, result) {
    const groups = (data.darcy || {groups: []}).groups, body = path => (data.runs.find(r => r.path === path) || {run: {attributes: {}}}).run.attributes.model_hash;
    const own = groups.find(g => g.tensor && g.runs.some(r => r.path === result.path));
    return (own || groups.find(g => g.tensor && body(result.path) && g.runs.some(r => body(r.path) === body(result.path))) || {}).tensor;
  }

  function notes(r) {
    const b = r.error_budget || {}, slope = Math.abs(r.dlnk_dvoid_ratio), closed = b.dlnk_sides_closed, more = 100 * Math.expm1(closed);
    return [
      b.scan_unknown && 'What the scan left in k, its blur, noise and labels, is not known and not counted.',
      b.sides_unknown && 'What the sample\u2019s sides do to k is not known and not counted: no pore leads through the lattice on which it is looked for.',
      known(b.blur_assumed_m) && 'The scanner\u2019s blur could not be measured: no surface stands alone in the scan. The part of the scan is that of a blur ' +
        `of ${digits(1e6 * b.blur_assumed_m)} µm.`,
      known(b.void_ratio) && known(r.dlnk_dvoid_ratio) && !known(b.threshold) &&
        `The void ratio was given without its ±, which is not counted: each 0.01 of it is ${percent(slope / 100)} of k.`,
      known(closed) && 'Sides: the sample is taken as periodic; mirrored at its sides instead, k changes by the part above. In a tube filled by the sample k would change by ' +
        (Math.abs(closed) > 1e-4 ? (more > 0 ? '+' : '\u2212') + digits(Math.abs(more), 2) : 'less than 0.01') + ' %.'].filter(t => t);
  }

  /* Results of one name, as of runs that differ only in their fluid, are distinguished by fluid and file. */
  function nameApart(results, runs) {
    const fluid = path => runs.filter(r => r.path === path).map(r => `${digits(r.run.attributes.viscosity, 4)} Pa s, ${digits(r.run.attributes.density, 4)} kg/m^3`);
    const names = results.map(r => r.name);
    results.filter(r => names.filter(n => n === r.name).length > 1).forEach(r => { r.apart = [r.name, ...fluid(r.path), r.path.replace(/.*\//, '')].join(', '); });
    results.forEach(r => { r.name = r.apart || r.name; });
  }

  const SOURCES = {
    lattices: 'From the lattices of this run, which tell more than the runs\u2019 spacings together.',
    extrapolated: 'Richardson extrapolation; the error holds the grid convergence index.',
    too_near: 'The spacings are too near each other to tell the error of the resolution.',
    scattered: 'The spacings do not converge well enough to extrapolate; the error is three times what they differ by.',
    gradients: 'Fitted through all gradients.'
  };

  /* ---- what the page begins with where it is no permeability: {value, error (95 %), unit, text: what the value is of, sentence} ---- */
  const judge = factor => (factor < 1 ? 'the soil is lifted' : factor < 1.5 ? 'little is in hand' : 'it stays');

  /* The safety of the soil's surface against uplift: the smallest factor of the exit gradient and of the prisms beside walls. */
  function uplift(s) {
    const exit = s.exit || {}, finer = exit.spacing_that_resolves_m;
    const [worst] = [exit, ...(s.heave || [])].filter(e => known(e.factor_of_safety)).sort((a, b) => a.factor_of_safety - b.factor_of_safety);
    const coarse = known(finer) && `The exit gradient beside a wall as shallow as here is not resolved: take a spacing of ${digits(finer, 2)} m`;
    if (!worst) return [coarse];
    const {factor_of_safety: factor, factor_of_safety_least: least, resolved} = worst;
    return [`Factor of safety against uplift ${digits(factor)}` + (!resolved ? coarse ? '' : ', which is not resolved: take a finer spacing' :
      (known(least) ? `, ${digits(least)} at least: ` : ': ') + judge(known(least) ? least : factor)), coarse];
  }

  /* The flow through the soil for each metre along y, from the most accurate source: outflow by wells and drains, else the flux of a
   * plane, else the flow net; and what it does. */
  function ofSeepage(s) {
    const taken = Object.values(s.taken_m2_per_s || {}), plane = taken.length === 0 && s.through, sum = key => taken.reduce((all, t) => all + t[key], 0);
    const [flow, error, where] = taken.length > 0 ?
      [sum('mean'), sum('error95'), 'taken out of the soil by wells and drains' + (sum('error95') === 0 ? ', as the scene gives it' : '')] :
      plane ? [plane.flux_m2_per_s, plane.error95, 'through the soil, at the plane ' + plane.plane] :
      [s.flow_m2_per_s, s.flow_error95_m2_per_s, 'through the soil, by the flow net'];
    const uptake = s.soil_uptake_m2_per_s, drift = plane ? 0 /* in the error */ : s.flow_drift_m2_per_s;
    const none = Math.abs(uptake) > 0.5 * flow || drift > 0.5 * flow;
    /* A smaller uptake is only in the error. */
    const filling = Math.abs(uptake) > 0.1 * flow && known(error) && Math.abs(uptake) > 0.5 * error;
    const sentences = [!none && 'For each metre along y', `The head falls by ${digits(s.head_drop_m)} m in the soil`,
                       filling && `The soil still ${uptake > 0 ? 'fills with' : 'drains of'} ${digits(Math.abs(uptake))} m²/s: run longer`,
                       s.heads_drift_m > 0 && 'Heads in it still go one way: run longer',
                       drift > 0.1 * flow && 'The velocities in it still go one way: run longer', ...uplift(s)];
    return {value: none ? null : flow, error: none ? null : error, unit: none ? '' : 'm²/s', text: none ? 'No steady flow through the soil' : where,
            sentence: sentences.filter(t => t).join('. ') + '.'};
  }

  const after = t => (t < 120 ? digits(t) + ' s' : t < 7200 ? (t / 60).toFixed(0) + ' min' : (t / 3600).toFixed(1) + ' h');

  /* Unsaturated soil: amount of water, and highest water table. */
  function ofMoisture(m) {
    const {x_m: x, level_m: levels} = m.water_table || {x_m: [], level_m: []}, top = Math.max(...levels.filter(known));
    return {value: m.water_m3, error: 0, unit: 'm³', text: `of water in the soil after ${after(m.time_s)}`,
            sentence: `${digits(m.water_at_start_m3)} m³ at the start` + (known(m.thickness_m) ? `, in a slice ${digits(m.thickness_m)} m thick along y` : '') +
              (known(top) ? `; the water table is highest at x = ${digits(x[levels.indexOf(top)])} m: ${digits(top)} m` : '') + '.'};
  }

  /* Free water: where it is at the end, and how fast; else why there is no k. */
  function ofFreeWater(data) {
    const h = data.history && (data.history.runs ? data.history.runs[0] : data.history), last = name => ((h && h.columns[name]) || {last: []}).last;
    const [low] = last('front_low'), [high, , top] = last('front_high'), [speed] = last('velocity_rms');
    const none = {value: null, error: null, unit: '', text: ''};
    if ([low, high, top].every(known))
      return {...none, text: 'Water after ' + after(h.end_time_s), sentence: `It lies between x = ${digits(low)} m and ${digits(high)} m, and up to z = ` +
        `${digits(top)} m` + (known(speed) ? `; its speed is ${digits(speed)} m/s (root of the mean square)` : '') + '.'};
    return {...none, sentence: data.runs[0].driven ? 'The flow has not settled, so there is no permeability to give: run it longer.' :
      'Nothing drives a flow through the whole body, so there is no permeability to give.'};
  }

  function fill(data) {
    const result = data.verdict[0], model = data.models[0], m = of(model, 'model');
    Object.assign(data.model, {rule: ruleOf(model), origin: of(model, 'provenance').origin || '', void_ratio_walls: m.void_ratio_measured + m.void_ratio_error});
    data.methods = methods(data);
    data.verdict.forEach(r => { r.note = SOURCES[r.from] || ''; });
    nameApart(data.verdict, data.runs);
    if (result) Object.assign(result, {class_din: classOf(DIN, result), class_casagrande: classOf(CASAGRANDE, result), formulas: formulas(data), notes: notes(result)});
    if (result) data.tensor = tensorOf(data, result);
    if (data.seepage || !result) data.headline = data.seepage ? ofSeepage(data.seepage) : data.moisture ? ofMoisture(data.moisture) : ofFreeWater(data);
    return data;
  }
  return {fill, mirrored};
})();
