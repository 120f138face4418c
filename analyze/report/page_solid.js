/* The view in three dimensions (three.js). */
const solid = (function () {
  'use strict';
  const {bytes} = pictures, {css} = tosui;
  const nibbles = (text, n) => {
    const packed = bytes(text), values = new Float32Array(n);
    for (let i = 0; i < n; i++) values[i] = (packed[i >> 1] >> (i % 2 * 4) & 15) / 15;
    return values;
  };

  /* Surface nets (Gibson 1998) of the field f = 1/2, closed by an empty border of two cells. Axes x y z of the
   * model; a vertex for each cell that the surface crosses, a quad for each edge. */
  function surface(f, size) {
    const [nx, ny, nz] = size.map(n => n + 4);
    const at = (x, y, z) => (z * ny + y) * nx + x;
    const g = new Float32Array(nx * ny * nz).fill(-0.5);
    for (let z = 0; z < size[2]; z++)
      for (let y = 0; y < size[1]; y++)
        for (let x = 0; x < size[0]; x++) g[at(x + 2, y + 2, z + 2)] = f[(z * size[1] + y) * size[0] + x] - 0.5 || -1e-4;
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
          positions.push(x + px / n - 1.5, y + py / n - 1.5, z + pz / n - 1.5);
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

  /* Five-sided tubes along the streamlines, coloured by speed. */
  function tubes(flow, radius) {
    const words = new Uint16Array(bytes(flow.points).buffer), group = new THREE.Group(), tint = new THREE.Color();
    const stops = ['#fdb42f', '#ed7953', '#cc4778', '#9c179e', '#0d0887'].map(c => new THREE.Color(c));
    const material = new THREE.MeshBasicMaterial({vertexColors: THREE.VertexColors}), sides = 5;
    let start = 0;
    for (const count of flow.lines) {
      const points = [], colours = [];
      for (let k = 4 * start; k < 4 * (start + count); k += 4) {
        points.push(new THREE.Vector3(words[k] / 500, words[k + 1] / 500, words[k + 2] / 500));
        const s = 4 * words[k + 3] / 65535, j = Math.min(Math.floor(s), 3);
        tint.copy(stops[j]).lerp(stops[j + 1], s - j);
        for (let n = 0; n <= sides; n++) colours.push(tint.r, tint.g, tint.b);
      }
      const tube = new THREE.TubeBufferGeometry(new THREE.CatmullRomCurve3(points), count - 1, radius, sides);
      tube.setAttribute('color', new THREE.Float32BufferAttribute(colours, 3));
      group.add(new THREE.Mesh(tube, material));
      start += count;
    }
    return group;
  }

  function mesh(shape, material) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.Float32BufferAttribute(shape.positions, 3));
    geometry.setIndex(shape.indices);
    geometry.computeVertexNormals();
    return new THREE.Mesh(geometry, material);
  }

  /* Grains, streamlines and, as another picture, the pores that carry half of the flow, in `box` that holds a canvas. Keys:
   * arrows turn, + and - come nearer and go. */
  function view(box, flow) {
    const renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
    renderer.localClippingEnabled = true;
    renderer.setPixelRatio(window.devicePixelRatio || 1);
    const size = flow.size, n = size[0] * size[1] * size[2], big = Math.max(size[0], size[1], size[2]);
    const grains = nibbles(flow.grains, n), group = new THREE.Group(), scene = new THREE.Scene();
    const plane = new THREE.Plane(new THREE.Vector3(0, 0, -1), 0);
    smooth(grains, size);
    const shape = surface(grains, size);
    const solid = mesh(shape, new THREE.MeshStandardMaterial(
      {color: 0xd6cec0, roughness: 0.9, metalness: 0, side: THREE.DoubleSide, clippingPlanes: [plane]}));
    const lines = tubes(flow, 0.004 * big);
    group.add(solid, lines);
    let paths = null;
    if (flow.paths) {
      const carriers = nibbles(flow.paths, n);
      smooth(carriers, size);
      paths = new THREE.Group();
      paths.add(mesh(surface(carriers.map(v => v + 0.12), size), new THREE.MeshStandardMaterial(
        {color: 0x145cb4, roughness: 0.6, side: THREE.DoubleSide})));
      paths.add(mesh(shape, new THREE.MeshStandardMaterial(
        {color: 0xd6cec0, transparent: true, opacity: 0.16, depthWrite: false, side: THREE.DoubleSide})));
      paths.visible = false;
      group.add(paths);
    }
    group.position.set(-size[0] / 2, -size[1] / 2, -size[2] / 2);
    const turned = new THREE.Group(); /* z of the model points up, y away from the eye */
    turned.add(group);
    turned.rotation.x = -Math.PI / 2;
    turned.add(new THREE.LineSegments(new THREE.EdgesGeometry(new THREE.BoxGeometry(size[0], size[1], size[2])),
                                      new THREE.LineBasicMaterial({color: 0x888888})));
    scene.add(turned, new THREE.HemisphereLight(0xffffff, 0x777788, 0.75));
    const sun = new THREE.DirectionalLight(0xffffff, 0.55);
    sun.position.set(-1, 2, 1.5);
    scene.add(sun);
    const camera = new THREE.PerspectiveCamera(35, 1, 0.1, 40 * big);
    camera.position.set(-1.35 * big, 1.05 * big, 2.3 * big);
    const canvas = renderer.domElement, controls = new THREE.OrbitControls(camera, canvas);
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', 'Grains and flow in three dimensions');
    box.appendChild(canvas);
    const draw = () => {
      scene.background = new THREE.Color(css('--card'));
      renderer.render(scene, camera);
    };
    const fit = () => {
      renderer.setSize(box.clientWidth, box.clientHeight);
      camera.aspect = box.clientWidth / box.clientHeight;
      camera.updateProjectionMatrix();
      draw();
    };
    const turns = {ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1]};
    canvas.addEventListener('keydown', event => {
      const turn = turns[event.key], nearer = {'+': 0.9, '=': 0.9, '-': 1.11}[event.key];
      if (!turn && !nearer) return;
      const way = new THREE.Spherical().setFromVector3(camera.position);
      if (turn) {
        way.theta -= turn[0];
        way.phi = Math.min(Math.max(way.phi + turn[1], 0.05), 3.1);
      } else {
        way.radius *= nearer;
      }
      camera.position.setFromSpherical(way);
      controls.update();
      draw();
      event.preventDefault();
    });
    controls.addEventListener('change', draw);
    window.addEventListener('resize', fit);
    fit();
    controls.update();
    const gl = renderer.getContext(), wide = gl.drawingBufferWidth, pixels = new Uint8Array(4 * wide);
    return {
      draw: draw,
      cut(share) {
        plane.constant = size[1] * (share - 0.5);
        draw();
      },
      show(carriers) {
        paths.visible = carriers;
        solid.visible = lines.visible = !carriers;
        draw();
      },
      /* How many pixels of the middle row differ from its first. */
      drawn() {
        gl.readPixels(0, gl.drawingBufferHeight >> 1, wide, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
        let n = 0;
        for (let i = 4; i < pixels.length; i += 4) if (pixels[i] !== pixels[0] || pixels[i + 1] !== pixels[1]) n++;
        return n;
      }
    };
  }
  return {view};
})();
