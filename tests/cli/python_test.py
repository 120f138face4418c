"""The Python module against the programs it runs, and against an exact k."""
import os
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "python"))
import tosui


def sphere(n=12, share=0.216):
    radius = (share * 3 / (4 * np.pi)) ** (1 / 3) * n
    at = np.arange(n) + 0.5 - n / 2
    z, y, x = np.meshgrid(at - 0.3, at + 0.21, at - 0.137, indexing="ij")
    return x**2 + y**2 + z**2 < radius**2, 2 * (radius * 320e-6 / n) ** 2 / (9 * share * 7.4419)  # Zick, Homsy 1982


class Module(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.grain, cls.exact = sphere()
        cls.result = tosui.permeability(cls.grain, 320e-6 / 12, pore=False, mirror=False, error=None, folder=cls.folder.name)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_k_of_spheres(self):
        r = self.result
        # Of the lattice with the voxels of the image; the limit of three so coarse ones is less near.
        self.assertLess(abs(r.K * r.run["k_finest"] / r.k / self.exact - 1), 0.02)
        self.assertTrue(r.K_low <= self.exact <= r.K_high)
        self.assertAlmostEqual(r.k / (r.K * 998.2 * 9.80665 / 1.002e-3), 1, places=6)
        self.assertTrue(r.k_low <= r.k <= r.k_high and r.k_low < r.k_high)
        self.assertAlmostEqual(r.darcy, r.K / 9.869233e-13)
        self.assertAlmostEqual(r.K_high / r.K, r.k_high / r.k)
        self.assertRegex(repr(r), r"^Permeability\(k=\S+ m/s \(\S+ to \S+\), K=\S+ m\^2, \S+ darcy, '\w+'\)$")

    def test_labels_and_axes(self):
        other = tosui.permeability(np.where(self.grain, 7, 3), "26.6666667 um", pore=3, mirror=False, error=None)
        self.assertAlmostEqual(other.K / self.result.K, 1, places=6)
        turned = tosui.permeability(~self.grain, "26.6666667 um", pore=True, mirror=False, error=None, axis="x")
        self.assertLess(abs(turned.K * turned.run["k_finest"] / turned.k / self.exact - 1), 0.03)

    def test_warnings_of_programs_are_warnings(self):
        image = np.full((16, 16, 16), 1, np.uint8)
        image[4:12, 4:12, 2:8] = 0  # a void that no flow passes
        with self.assertWarnsRegex(UserWarning, "^ct2model: warning: "):
            tosui.permeability(image, "10 um", pore=0)

    def test_load(self):
        model = tosui.load(os.path.join(self.folder.name, "model.hdf"))
        self.assertEqual(model.solid.shape, (12, 12, 12))
        self.assertEqual((model.spacing.unit, model.wall_distance.unit), ("m", "m"))
        self.assertAlmostEqual(model.void_ratio, self.result.void_ratio)
        self.assertEqual(int((np.asarray(model.solid) != self.grain).sum()), 0)
        run = tosui.load(os.path.join(self.folder.name, "run.hdf"))
        self.assertAlmostEqual(run.k, self.result.k)
        self.assertEqual(run.history["darcy_velocity"].unit, "m/s")
        self.assertIn("fluids", run.scene)
        shot = run.snapshot()
        self.assertEqual(shot.fields["velocity"].shape, shot.points.shape)
        self.assertEqual(shot.fields["velocity"].unit, "m/s")
        darcy = -shot.fields["velocity"][:, 2].sum() / 12**3
        self.assertLess(abs(darcy / run.attributes["darcy_velocity"][2] + 1), 0.05)
        for shown in (model, run, shot):
            self.assertRegex(repr(shown), r"^(Model|Run|Snapshot)\('[^\n]{20,150}\)$")

    def test_table(self):
        table = tosui.table("darcy", os.path.join(self.folder.name, "run.hdf"))
        self.assertAlmostEqual(table["k_m_per_s"] / self.result.k, 1, places=4)
        self.assertEqual(tosui.table("darcy", os.path.join(self.folder.name, "run.hdf"), mix=False, output=None), table)

    def test_errors_say_what_is_wrong(self):
        for words, image, size in ((("3 axes",), np.zeros((4, 4)), 1e-6), (("label 5",), self.grain, 1e-6),
                                   (("1 nm to 1 cm",), self.grain, 5.0)):
            with self.assertRaises(tosui.TosuiError) as caught:
                tosui.permeability(image, size, pore=5 if words == ("label 5",) else False)
            self.assertIn(words[0], str(caught.exception))
        for path, said in ((__file__, "no HDF5 file"), ("nothere.hdf", "nothere.hdf: No such file or directory")):
            with self.assertRaises(tosui.TosuiError) as caught:
                tosui.load(path)
            self.assertIn(said, str(caught.exception))
        with self.assertRaisesRegex(tosui.TosuiError, "a folder; name a file in it"):
            tosui.load(self.folder.name)
        with self.assertRaisesRegex(tosui.TosuiError, "File exists"):
            tosui.permeability(self.grain, "5 um", pore=False, folder=os.path.join(self.folder.name, "run.hdf"))
        with self.assertWarnsRegex(UserWarning, "name pore=True"), self.assertRaises(tosui.TosuiError):
            tosui.permeability(self.grain, 5.0)  # False or True, that is not said
        with self.assertRaises(tosui.TosuiError) as caught:
            tosui.permeability(np.ones((4, 4, 4), int) * np.arange(4), 1e-6, void_ratio=-1)
        self.assertEqual(caught.exception.code, 2)
        with self.assertRaisesRegex(tosui.TosuiError, r"error 15: .*error=0.15 is 15 %"):
            tosui.permeability(self.grain, 1e-6, pore=False, error=15)

    def test_arrays_that_are_no_image(self):
        grain = self.grain.astype(np.uint8)
        for said, image in (("none of them empty", np.zeros((4, 0, 4))), ("not of one length", [[[1, 2], [3]]]),
                            ("not the name of a file", "scan.tif"), ("not the name of a file", None), ("complex128", grain * 1j),
                            ("a mask is neither", np.ma.masked_array(grain, mask=grain)),
                            ("beyond 32 bits", grain.astype(np.int64) * 5_000_000_000)):
            with self.assertRaisesRegex(tosui.TosuiError, said):
                tosui.permeability(image, "5 um")
        named = grain.view(type("Named", (np.ndarray,), {"dims": ("x", "y", "z")}))  # as of xarray
        with self.assertRaisesRegex(tosui.TosuiError, "axes are x, y, z; give it as image.transpose"):
            tosui.permeability(named, "5 um")
        type(named).dims = ("z", "y", "x")
        self.assertTrue(np.array_equal(tosui._volume(named), grain))
        # Whatever holds the same values is the same image.
        for image in (grain.tolist(), np.asfortranarray(grain), grain.astype(">i4"), grain.astype(np.float16), grain.astype(np.uint64)):
            self.assertTrue(np.array_equal(tosui._volume(image), grain))

    def test_labels_that_few_digits_do_not_name(self):
        grain = self.grain.astype(np.float64)
        for low, high in ((0.1, 0.2), (123456, 123457), (16777218, 16777220)):
            said = tosui._phases(low + (high - low) * grain, low)
            one = tosui.permeability(low + (high - low) * grain, "26.6666667 um", pore=low, mirror=False, error=None)
            self.assertAlmostEqual(one.K / self.result.K, 1, places=6, msg=said)
        with self.assertRaisesRegex(tosui.TosuiError, "single precision does not part"):
            tosui.permeability(self.grain.astype(np.int32) + 123456789, "5 um", pore=123456789)

    def test_words_that_are_no_number(self):
        for said, options in (("voxel_size None", {"voxel_size": None}), ("pore 'x'", {"pore": "x"}), ("axis 3", {"axis": 3}),
                              ("axis None", {"axis": None}), (r"axis \[\]", {"axis": []}), ("size 4", {"size": 4}), ("size", {"size": (4, 4)}),
                              (r"pore \[\] names no label; the image holds 0, 1", {"pore": []}),
                              ("give one$", {"pore": True, "void_ratio": 0.7}),
                              (r"pore \[0\]: a number", {"pore": [[0], [1, 2]]}), ("pore 1000", {"pore": 10**400}),
                              ("mirror 'no'", {"mirror": "no"}), ("folder 3", {"folder": 3}), ("folder 'a", {"folder": "a\0b"}),
                              ("null byte", {"voxel_size": "5\0um"}), ("one is wanted here", {"pore": 0, "void_ratio": "0.6,0.7"}),
                              (r"void_ratio \[", {"pore": 0, "void_ratio": [0.6, 0.7]}),
                              ("10000000 is out of range", {"size": (10000000, 4, 4)}),
                              ("viscosity '1 Pa s'", {"viscosity": "1 Pa s"}), ("density None", {"density": None})):
            with self.assertRaisesRegex(tosui.TosuiError, said):
                tosui.permeability(self.grain, **{"voxel_size": "5 um", "pore": False, **options})
        with self.assertRaises(tosui.TosuiError) as caught:
            tosui.permeability(self.grain, "5 um", pore=False, error="5")
        self.assertIn("5", str(caught.exception))

    def test_files_that_are_no_run(self):
        import h5py
        at = self.folder.name
        for said, path in (("for ParaView; its fields", os.path.join(at, "run-image.hdf")), ("not ''", ""), ("path 3: the name", 3),
                           ("path None: the name", None), ("^nothere.hdf: No such", b"nothere.hdf")):
            with self.assertRaisesRegex(tosui.TosuiError, said):
                tosui.load(path)
        with self.assertRaisesRegex(tosui.TosuiError, r"run \['a.hdf'\]: the name"):
            tosui.table("darcy", ["a.hdf"])
        with h5py.File(os.path.join(at, "half.hdf"), "w") as half:
            half["model/solid"] = np.zeros((2, 2, 2))
            half["run/history"] = 0
        with self.assertRaisesRegex(tosui.TosuiError, "half.hdf: not as Tosui writes it"):
            tosui.load(os.path.join(at, "half.hdf"))
        # What the programs do not follow is not followed here.
        model, linked = os.path.join(at, "model.hdf"), os.path.join(at, "linked.hdf")
        for name, link in (("model", h5py.ExternalLink(model, "/model")), ("model/solid", h5py.ExternalLink(model, "/model/solid")),
                           ("model/solid", h5py.VirtualLayout((2, 2, 2), "u1"))):
            with h5py.File(linked, "w") as file:
                if isinstance(link, h5py.VirtualLayout):
                    link[:] = h5py.VirtualSource(model, "model/solid", (12, 12, 12))[:2, :2, :2]
                    file.create_virtual_dataset(name, link)
                else:
                    file[name] = link
                file["itself"] = file["/"]
            with self.assertRaisesRegex(tosui.TosuiError, "linked.hdf: /" + name + " is (a link into|stored in) another file"):
                tosui.load(linked)
        run = tosui.load(os.path.join(at, "run.hdf"))
        with self.assertRaisesRegex(tosui.TosuiError, "no snapshot 1; it has 1"):
            run.snapshot(1)
        del run.attributes["k"]
        with self.assertRaisesRegex(tosui.TosuiError, "without a k"):
            run.k

    def test_programs_that_are_none(self):
        here, before = os.path.join(self.folder.name, "bin"), os.environ.get("TOSUI_BIN")
        os.makedirs(here)
        os.environ["TOSUI_BIN"] = here
        try:
            for said, script in (("Exec format error", "no program"), ("SIGKILL; .* memory is short", "#!/bin/sh\nkill -9 $$\n"),
                                 ("printed no JSON", "#!/bin/sh\necho so\n")):
                with open(os.path.join(here, "ct2model"), "w") as program:
                    program.write(script)
                os.chmod(program.name, 0o755)
                with self.assertRaisesRegex(tosui.TosuiError, said):
                    tosui.permeability(self.grain, "5 um", pore=False)
        finally:
            os.environ["TOSUI_BIN"] = before or ""


if __name__ == "__main__":
    unittest.main()
