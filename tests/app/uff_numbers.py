"""Universal files of a run, by a parser of its own, beside the numbers of the run file."""

import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

os.environ["HDF5_USE_FILE_LOCKING"] = "FALSE"
try:
    import h5py
    import numpy as np
except ImportError as error:
    print(f"not run: {error}")
    sys.exit(77)  # skipped

PROGRAM = os.environ["STRIDOR_PROGRAM"]
REED = str(pathlib.Path(__file__).parents[2] / "scenes" / "examples" / "reed.yaml")


def verb(*words):
    subprocess.run([PROGRAM, *words], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def columns(lines, width):
    return [float(line[at:at + width]) for line in lines for at in range(0, len(line), width)]


def functions(path):
    """Name, abscissas, values of every dataset 58; the widths are those of the format alone."""
    data = pathlib.Path(path).read_bytes()
    found = {}
    at = 0
    while (at := data.find(b"    -1\n    58", at)) >= 0:
        lines = data[at:].split(b"\n", 13)
        head = lines[1].decode()
        records = [line.decode() for line in lines[2:13]]
        kind, count, even = (int(records[6][i:i + 10]) for i in (0, 10, 20))
        first, step = (float(records[6][i:i + 13]) for i in (30, 43))
        body = at + sum(len(line) + 1 for line in lines[:13])
        parts = 2 if kind > 4 else 1
        per_point = parts + (0 if even else 1)
        if head[6:7] == "b":
            size = 8 if kind in (4, 6) else 4
            num_bytes = int(head[31:43])
            assert num_bytes == count * per_point * size
            numbers = struct.unpack("<%d%s" % (count * per_point, "d" if size == 8 else "f"), data[body:body + num_bytes])
            end = body + num_bytes
        else:
            end = data.index(b"    -1\n", body)
            text = data[body:end].decode().splitlines()
            numbers = []
            for line in text:
                if kind in (2, 5):
                    numbers += columns([line], 13)
                elif even:
                    numbers += columns([line], 20)
                else:  # E13.5, then one or two of E20.12, perhaps twice
                    while line:
                        numbers.append(float(line[:13]))
                        line = line[13:]
                        for _ in range(parts):
                            numbers.append(float(line[:20]))
                            line = line[20:]
        assert data[end:end + 7] == b"    -1\n"
        table = np.array(numbers).reshape(count, per_point)
        abscissas = first + step * np.arange(count) if even else table[:, 0]
        values = table[:, -1] if parts == 1 else table[:, -2] + 1j * table[:, -1]
        found[records[0].strip()] = (abscissas, values)
        at = end
    return found


class Numbers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.run_file = cls.at("reed.h5")
        verb("run", REED, "-o", cls.run_file)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def at(cls, name):
        return os.path.join(cls.folder.name, name)

    def test_histories_of_a_run(self):
        with h5py.File(self.run_file, "r") as opened:
            time = opened["time"][:]
            series = {name: opened["channels"][name][:] for name in opened["channels"]}
            series["contact.force"] = opened["contact/contact/force"][:]
        for words, relative in ((), 1e-12), (("--single",), 5e-6), (("--binary",), 0.0), (("--binary", "--single"), 2.0**-24):
            file = self.at("a.uff")
            verb("plot", self.run_file, "--kind", "history", "--data", file, "--force", *words)
            written = functions(file)
            self.assertEqual(len(written), 3)
            for name, (abscissas, values) in written.items():
                np.testing.assert_allclose(abscissas, time, rtol=0, atol=1e-9 * time[-1])
                np.testing.assert_allclose(values, series[name], rtol=relative, atol=1e-40)

    def test_responses(self):
        words = ("frf", REED, "--input", "reed.middle.y", "--from", "100Hz", "--to", "3kHz", "--points", "100")
        for scale in "linear", "log":
            verb(*words, "--scale", scale, "-o", self.at("a.h5"), "-o", self.at("a.uff"), "--force")
            verb(*words, "--scale", scale, "-o", self.at("b.uff"), "--binary", "--force")
            verb(*words, "--scale", scale, "-o", self.at("c.uff"), "--binary", "--single", "--force")
            with h5py.File(self.at("a.h5"), "r") as opened:
                group = opened["responses/reed.middle.y.acceleration/reed.middle.y"]
                response = group["real"][:] + 1j * group["imaginary"][:]
                frequency = opened["frequency"][:]
            for file, relative, of_frequency in ("a.uff", 2e-12, 5e-6), ("b.uff", 0.0, 1e-12), ("c.uff", 2.0**-23, 2.0**-23):
                (abscissas, values), = functions(self.at(file)).values()
                np.testing.assert_allclose(abscissas, frequency, rtol=of_frequency)
                np.testing.assert_allclose(values, response, rtol=relative)


if __name__ == "__main__":
    unittest.main()
