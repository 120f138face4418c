"""Tosui from Python: models and runs as arrays with units, and the permeability of an image.

    import tosui
    result = tosui.permeability(image, "5 um", pore=0)     # image[z, y, x] of labels
    print(result.k, result.k_low, result.k_high, result.K) # m/s, 95 %; m^2
    model, run = tosui.load("model.hdf"), tosui.load("run.hdf")

Needs numpy and h5py; permeability() and table() run the programs ct2model, sphsolve and analyze, which are looked for in
TOSUI_BIN, beside a source tree's build/, and on the PATH.
"""
import dataclasses
import json
import os
import shutil
import signal
import subprocess
import tempfile
import warnings

import h5py
import numpy as np

__all__ = ["Array", "Model", "Permeability", "Run", "Snapshot", "TosuiError", "load", "permeability", "table"]

DARCY = 9.869233e-13  # m^2


class TosuiError(RuntimeError):
    """What a program said; `code` is its exit code (2 usage, 3 input, 4 numerical failure)."""

    def __init__(self, message, code=None):
        super().__init__(message)
        self.code = code


class Array(np.ndarray):
    """A numpy array that knows its unit ("m/s"; "1" for none)."""

    def __new__(cls, values, unit="1"):
        array = np.asarray(values).view(cls)
        array.unit = unit
        return array

    def __array_finalize__(self, other):
        self.unit = getattr(other, "unit", "1")


def _text(value):
    return value.decode() if isinstance(value, bytes) else value


def _attributes(node):
    return {name: _text(value.item() if isinstance(value, np.ndarray) and value.size == 1 else value)
            for name, value in node.attrs.items()}


def _read(dataset, unit=None):
    return Array(dataset[()], _text(dataset.attrs.get("unit", unit or "1")))


@dataclasses.dataclass
class Model:
    """A voxel model: arrays are [z, y, x]."""

    path: str
    solid: Array  # 1 grain, 0 pore
    spacing: Array  # m; z, y, x
    wall_distance: Array = None  # m, positive in the pore
    grain_fraction: Array = None
    attributes: dict = dataclasses.field(default_factory=dict)

    @property
    def porosity(self):
        return 1.0 - float(self.solid.mean())

    @property
    def void_ratio(self):
        return self.porosity / (1.0 - self.porosity)

    def __repr__(self):
        size = " x ".join(str(n) for n in reversed(self.solid.shape))
        edges = " x ".join(f"{1e6 * float(h):.4g}" for h in reversed(self.spacing))
        return f"Model('{self.path}', {size} voxels (x, y, z) of {edges} um, porosity {self.porosity:.4g})"


@dataclasses.dataclass
class Snapshot:
    """Fields at the particles or sites `points` (m); fields["velocity"] is [n, 3] in m/s."""

    path: str
    time: float
    points: Array
    fields: dict

    def __repr__(self):
        return f"Snapshot('{self.path}', {self.time:g} s, {len(self.points)} points with {', '.join(self.fields)})"


@dataclasses.dataclass
class Run:
    """A run: `history` holds arrays by name, `attributes` what stands in /run, as k (m/s)."""

    path: str
    history: dict
    attributes: dict
    scene: str
    snapshot_names: list
    snapshot_times: Array

    @property
    def k(self):
        return self._found("k")

    @property
    def K(self):
        return self._found("intrinsic_permeability")

    def _found(self, name):
        if name not in self.attributes:
            raise TosuiError(f"{self.path}: a run without a k: nothing drives its water through, or it has not settled")
        return float(self.attributes[name])

    def __repr__(self):
        flow = f", k={self.k:.4g} m/s" if "k" in self.attributes else ""
        return f"Run('{self.path}', method {self.attributes.get('method')}{flow}, {len(self.snapshot_names)} snapshots)"

    def snapshot(self, number=-1):
        """The snapshot of that number, the last by default."""
        if not -len(self.snapshot_names) <= number < len(self.snapshot_names):
            raise TosuiError(f"{self.path}: no snapshot {number}; it has {len(self.snapshot_names)}, counted from 0")
        return load(os.path.join(os.path.dirname(self.path), self.snapshot_names[number]))


def _load_model(path, file):
    group = file["model"]
    optional = {name: _read(group[name], unit) for name, unit in (("wall_distance", "m"), ("grain_fraction", "1"))
                if name in group}
    return Model(path, _read(group["solid"]), Array(group.attrs["spacing"], "m"), attributes=_attributes(group), **optional)


def _load_run(path, file):
    group = file["run"]
    history = {name: _read(data) for name, data in file["history"].items()} if "history" in file else {}
    snapshots = group.get("snapshots", {})
    names = [_text(name) for name in snapshots["name"][()]] if "name" in snapshots else []
    times = Array(snapshots["time"][()] if "time" in snapshots else [], "s")
    scene = _text(group["scene"][()]) if "scene" in group else ""
    return Run(path, history, _attributes(group), scene, names, times)


def _load_snapshot(path, file):
    group = file["VTKHDF"]
    fields = {name: _read(data) for name, data in group["PointData"].items()}
    return Snapshot(path, float(file.attrs["time"]), Array(group["Points"][()], "m"), fields)


def _path(name, value):
    try:
        return os.fsdecode(value)
    except TypeError:
        raise TosuiError(f"{name} {value!r}: the name of a file is wanted, as a text or a pathlib.Path") from None


def _stay_inside(path, group, seen=()):
    """Refuses what leads out of a file, as the programs do: links into others, and datasets stored elsewhere."""
    address = h5py.h5o.get_info(group.id).addr
    if address in seen:  # a group within itself
        return
    for name in group:
        link = group.get(name, getlink=True)
        place = f"{group.name.rstrip('/')}/{name}"
        if isinstance(link, h5py.ExternalLink):
            raise TosuiError(f"{path}: {place} is a link into another file, which is not followed")
        item = None if isinstance(link, h5py.SoftLink) else group[name]
        if isinstance(item, h5py.Group):
            _stay_inside(path, item, (*seen, address))
        elif isinstance(item, h5py.Dataset) and (item.is_virtual or item.external):
            raise TosuiError(f"{path}: {place} is stored in another file, which is not read")


def load(path):
    """A model, a run or a snapshot, by what the file holds."""
    path = _path("path", path)
    if not path or os.path.isdir(path):
        raise TosuiError(f"{path}: a folder; name a file in it" if path else "the name of a file is wanted, not ''")
    try:
        with h5py.File(path, "r") as file:
            _stay_inside(path, file)
            if "VTKHDF/PointData/time" in file:
                raise TosuiError(f"{path}: the ways of walkers, for ParaView; read VTKHDF/Points, PointData/time and id"
                                 " with h5py")
            for name, read in (("model/solid", _load_model), ("run", _load_run), ("VTKHDF/Points", _load_snapshot)):
                if name in file:
                    return read(path, file)
            if "VTKHDF/PointData" in file:
                raise TosuiError(f"{path}: the image that stands beside a run, for ParaView; its fields are in"
                                 " /VTKHDF/PointData, [z, y, x]; load the run, or read them with h5py")
    except KeyError as error:
        raise TosuiError(f"{path}: not as Tosui writes it: {error.args[0]}") from None
    except FileNotFoundError:
        raise TosuiError(f"{path}: No such file or directory") from None
    except OSError as error:
        cause = error if not os.path.isfile(path) or h5py.is_hdf5(path) else "no HDF5 file, or a damaged one"
        raise TosuiError(f"{path}: {cause}") from None
    raise TosuiError(f"{path}: neither a model nor a run nor a snapshot of Tosui")


def _program(name):
    here = os.path.dirname(os.path.abspath(__file__))
    for folder in (os.environ.get("TOSUI_BIN"), os.path.join(here, "..", "build", "bin")):
        if folder and os.access(os.path.join(folder, name), os.X_OK):
            return os.path.join(folder, name)
    found = shutil.which(name)
    if found is None:
        raise TosuiError(f"{name} is not on the PATH; set TOSUI_BIN to the folder of the programs")
    return found


def _run(name, *words):
    """The JSON object that a program prints; what it says goes into the error."""
    program = _program(name)
    try:
        done = subprocess.run([program, *map(str, words), "--json"], capture_output=True, text=True)
    except OSError as error:
        raise TosuiError(f"{program}: {error.strerror}") from None
    except ValueError as error:  # a NUL or half a character, which no program can be given
        raise TosuiError(f"{' '.join(map(str, words))!r}: {error}") from None
    if done.returncode < 0:
        memory = "; the system does so where memory is short" if done.returncode == -signal.SIGKILL else ""
        raise TosuiError(f"{program} was ended by {signal.Signals(-done.returncode).name}{memory}", done.returncode)
    if done.returncode != 0:
        raise TosuiError(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else name, done.returncode)
    for line in done.stderr.splitlines():
        if line.startswith(f"{name}: warning: "):
            warnings.warn(line, stacklevel=3)
    try:
        return json.loads(done.stdout), done.stderr
    except ValueError:
        raise TosuiError(f"{program} printed no JSON: is it Tosui's?") from None


def table(command, *runs, **options):
    """What `analyze COMMAND RUN...` finds, as a dictionary: table("darcy", "a.hdf", "b.hdf", mix=True)."""
    words = []
    for name, value in options.items():
        if value is None or value is False:
            continue
        words += ["--" + name.replace("_", "-")] + ([] if value is True else [value])
    return _run("analyze", command, *(_path("run", path) for path in runs), *words)[0]


@dataclasses.dataclass
class Permeability:
    """k, k_low, k_high: hydraulic conductivity in m/s (of water at 20 degrees unless said otherwise) and its 95 % bounds;
    K, K_low, K_high: permeability in m^2. `model` and `run` are what the programs printed, `messages` what they said."""

    k: float
    k_low: float
    k_high: float
    K: float
    void_ratio: float
    status: str
    model: dict
    run: dict
    messages: str

    def __repr__(self):
        return (f"Permeability(k={self.k:.4g} m/s ({self.k_low:.4g} to {self.k_high:.4g}), K={self.K:.4g} m^2, "
                f"{self.darcy:.4g} darcy, {self.status!r})")

    @property
    def K_low(self):
        return self.K * self.k_low / self.k if self.k else 0.0

    @property
    def K_high(self):
        return self.K * self.k_high / self.k if self.k else 0.0

    @property
    def darcy(self):
        return self.K / DARCY


_SCENE = """scene = {{ name = "image"; method = "stokes"; }};
model = {{ file = "model.hdf"; }};
fluids = ( {{ name = "fluid"; density = "{density:.9g} kg/m^3"; viscosity = "{viscosity:.9g} Pa s"; }} );
force = {{ body_acceleration = ["0", "0", "-9.80665 m/s^2"]; }};
"""


def _number(name, value):
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise TosuiError(f"{name} {value!r}: a number is wanted") from None


def _length(value):
    return value if isinstance(value, str) else f"{_number('voxel_size', value):.9g} m"


def _volume(image):
    """The array as ct2model reads it, every value what it was."""
    if np.ma.isMaskedArray(image):
        raise TosuiError("the image is a masked array, and a mask is neither pore nor grain;"
                         " fill it (image.filled(label)) or cut it out")
    named = [str(name).lower() for name in getattr(image, "dims", ())]  # of xarray
    if sorted(named) == ["x", "y", "z"] and named != ["z", "y", "x"]:
        raise TosuiError(f"the image's axes are {', '.join(named)}; give it as image.transpose('z', 'y', 'x')")
    try:
        image = np.asarray(image)
    except ValueError:
        raise TosuiError("the image's rows are not of one length") from None
    if image.dtype.kind not in "biuf":
        raise TosuiError(f"the image is an array of {image.dtype}; integers, truth values or floats are wanted,"
                         " [z, y, x], not the name of a file")
    if image.ndim != 3 or image.size == 0:
        raise TosuiError(f"the image has the shape {image.shape}; 3 axes are wanted, [z, y, x], none of them empty")
    if image.dtype.kind == "f" and image.dtype.itemsize not in (4, 8):
        return image.astype(np.float32 if image.dtype.itemsize < 4 else np.float64)
    if image.dtype.itemsize == 8 and image.dtype.kind in "iu":
        small = image.astype(np.int32)
        if not np.array_equal(small, image):
            raise TosuiError("the image holds integers beyond 32 bits; scale them, or number the labels anew")
        return small
    return image


def _phases(image, pore):
    """--segmented and its list: the labels in `pore`, the others grain. ct2model reads pixels in single precision."""
    values = np.unique(image)
    if len(values) > 32:
        raise TosuiError("the image holds more than 32 labels; give void_ratio for an image of greys")
    labels = np.unique(values.astype(np.float32))
    if len(labels) < len(values):
        raise TosuiError("the image holds labels that single precision does not part; number them anew")
    named = pore if np.iterable(pore) and not isinstance(pore, (str, bytes)) else [pore]
    if not len(named):
        raise TosuiError(f"pore {pore!r} names no label; the image holds {', '.join(f'{x:g}' for x in labels[:8])}")
    pores = np.isin(labels, np.array([_number("pore", label) for label in named], np.float32))
    if not pores.any():
        raise TosuiError(f"the image does not hold the label {pore}, only {', '.join(f'{x:g}' for x in labels[:8])}")
    return "--segmented=" + ",".join(f"{x:.9g}={'pore' if open else 'grain'}" for x, open in zip(labels, pores))


def permeability(image, voxel_size, pore=0, error=0.05, axis="z", *, void_ratio=None, size=None, mirror=True,
                 density=998.2, viscosity=1.002e-3, folder=None, threads=None):
    """The permeability of image[z, y, x] along `axis` ("z" is the first axis of the array, "x" the last).

    An image of labels: `pore` is the label, or the labels, of pores (of a boolean image name it: pore=True or
    pore=False; without, False is pore, other than in PoreSpy, and a warning says so). An image of greys,
    where grains are bright: give the measured `void_ratio`. `voxel_size`: metres, a text with a unit ("5 um"), or three
    of them for x, y and z. `error`: relative; None for that of the voxels as they are. `size`: (nx, ny, nz) to resample
    to. `mirror`: the image and its mirror image stand one behind the other along the flow, so that pores fit; False
    for an image that is periodic. `folder` keeps the files. Raises TosuiError with the program's message."""
    image = _volume(image)
    if isinstance(axis, (int, np.integer)) and -3 <= axis < 3:
        axis = "zyx"[axis]
    if not isinstance(axis, str) or axis not in ("x", "y", "z"):
        raise TosuiError(f"axis {axis!r}: 'x', 'y' or 'z' is wanted")
    if not isinstance(mirror, (bool, np.bool_)):
        raise TosuiError(f"mirror {mirror!r}: True or False is wanted")
    if image.dtype == bool:
        if void_ratio is None and pore is not True and pore is not False:
            warnings.warn(f"a boolean image: pores are where it is {bool(pore)}; name pore=True or pore=False", stacklevel=2)
        image = image.astype(np.uint8)
    if void_ratio is not None and (isinstance(pore, (bool, np.bool_)) or np.ndim(pore) > 0 or pore != 0):
        raise TosuiError(f"void_ratio and pore={pore!r}: the first is for an image of greys, pore for labels; give one")
    if void_ratio is not None and not isinstance(void_ratio, str):
        void_ratio = f"{_number('void_ratio', void_ratio):.9g}"
    if void_ratio is not None and "," in void_ratio:
        raise TosuiError(f"void_ratio {void_ratio!r}: one is wanted here; call once for each")
    lengths = [voxel_size] if isinstance(voxel_size, str) else np.atleast_1d(voxel_size)
    words = ["--voxel-size", ",".join(_length(length) for length in lengths), "--flow", axis]
    words += ["--mirror", "z" if mirror else "none"]
    words += [_phases(image, pore)] if void_ratio is None else ["--void-ratio", void_ratio]
    if size is not None and (isinstance(size, str) or np.size(size) != 3):
        raise TosuiError(f"size {size!r}: three numbers are wanted, (nx, ny, nz)")
    words += ["--size", "x".join(f"{_number('size', n):.9g}" for n in size)] if size is not None else []
    water = {"density": _number("density", density), "viscosity": _number("viscosity", viscosity)}
    goal = []
    if error is not None:
        goal = ["--error", error if isinstance(error, str) else f"{100 * _number('error', error):g}%"]
        if not isinstance(error, str) and float(error) > 1:
            raise TosuiError(f"error {error!r}: a share of k is wanted; error={float(error) / 100:g} is {float(error):g} %")
    common = ["--threads", threads] if threads else []
    at = _path("folder", folder) if folder is not None else None
    with tempfile.TemporaryDirectory(prefix="tosui-") as own:
        at = own if at is None else at
        try:
            os.makedirs(at, exist_ok=True)
            np.save(os.path.join(at, "image.npy"), np.ascontiguousarray(image))
            with open(os.path.join(at, "scene.cfg"), "w") as scene:
                scene.write(_SCENE.format(**water))
        except (OSError, ValueError) as failed:
            raise TosuiError(f"folder {at!r}: {getattr(failed, 'strerror', None) or failed}") from None
        model, said = _run("ct2model", "build", os.path.join(at, "image.npy"), *words, *common, "-o",
                           os.path.join(at, "model.hdf"))
        run, more = _run("sphsolve", "run", os.path.join(at, "scene.cfg"), *goal, *common, "-o", os.path.join(at, "run"))
    k = run["k"]
    relative = run.get("k_relative_error") or 0.0
    low, high = run.get("k_low"), run.get("k_high")
    return Permeability(k, k * max(0.0, 1 - relative) if low is None else low, k * (1 + relative) if high is None else high,
                        run["intrinsic_permeability"], model["void_ratio"], run["status"], model, run, said + more)
