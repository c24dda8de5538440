import csv

import numpy as np
import pytest

from fissura.errors import InputError
from fissura.results.curve import COLUMNS, columns, read_curve, row
from fissura.results.curve_writer import CurveWriter

from .synthetic import snapping, step, steps


def rows():
    return [row(s, 0.1 * s.number, 0.2 * s.number) for s in steps([100.0, 250.0, 1 / 3])]


def write(path, lines):
    path.write_text("\n".join(lines) + "\n")
    return path


def test_written_curve_reads_back(tmp_path):
    writer = CurveWriter(tmp_path / "curve.csv")
    for values in rows():
        writer.write(values)
    writer.close()
    read, kept = read_curve(tmp_path / "curve.csv"), columns(rows())
    assert tuple(read) == COLUMNS
    assert read.pop("control").tolist() == kept["control"].tolist() == ["gauge"] * 3
    for name in read:
        np.testing.assert_allclose(read[name], kept[name], rtol=1e-11)
        assert read[name].dtype == kept[name].dtype
    assert read["step"].dtype == np.int64
    assert read["load_N"].dtype == np.float64


def test_every_row_is_on_disk_before_the_file_is_closed(tmp_path):
    writer = CurveWriter(tmp_path / "curve.csv")
    assert len(read_curve(tmp_path)["step"]) == 0
    for count, values in enumerate(rows(), 1):
        writer.write(values)
        assert len(read_curve(tmp_path)["step"]) == count
    writer.close()


def test_file_is_plain_csv_with_units_in_the_first_line(tmp_path):
    writer = CurveWriter(tmp_path / "curve.csv")
    writer.write(rows()[0])
    writer.close()
    with (tmp_path / "curve.csv").open(newline="") as file:
        (read,) = csv.DictReader(file)
    assert list(read)[:4] == ["step", "gauge_m", "load_N", "load_displacement_m"]
    assert read["step"] == "1"
    assert float(read["load_N"]) == 100.0


def test_unknown_utilisation_survives(tmp_path):
    writer = CurveWriter(tmp_path / "curve.csv")
    writer.write(row(step(1, 1e-6, 5.0, max_elastic_utilisation=float("nan")), 0.0, 0.0))
    writer.close()
    assert np.isnan(read_curve(tmp_path)["max_elastic_utilisation"][0])


def test_what_led_is_told(tmp_path):
    writer = CurveWriter(tmp_path / "curve.csv")
    for taken in snapping():
        writer.write(row(taken, 0.0, 0.0))
    writer.close()
    assert read_curve(tmp_path)["control"].tolist() == ["gauge"] * 2 + ["dissipation"] * 4
    assert read_curve(tmp_path)["linear_iterations"].tolist() == [30] * 6


def test_further_columns_are_kept(tmp_path):
    header = ",".join([*COLUMNS, "mine"])
    write(tmp_path / "curve.csv", [header, ",".join("1" for _ in range(len(COLUMNS) + 1))])
    assert read_curve(tmp_path)["mine"] == [1.0]


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([""], "has no column step"),
        (["step,gauge_m", "1,2"], "has no column load_N"),
        ([",".join(COLUMNS), "1,2"], "line 2: has 2 values"),
        ([",".join(COLUMNS), ",".join(["1"] * (len(COLUMNS) - 3) + ["fast", "gauge", "1"])], "wall_s is 'fast'"),
        ([",".join(COLUMNS), ",".join(["1.5"] + ["1"] * (len(COLUMNS) - 1))], "step is '1.5'"),
    ],
)
def test_broken_files_say_what_is_wrong(tmp_path, lines, message):
    with pytest.raises(InputError, match=message):
        read_curve(write(tmp_path / "curve.csv", lines))


def test_missing_and_binary_files(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_curve(tmp_path)
    (tmp_path / "curve.csv").write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(InputError, match="is UTF-16 text"):
        read_curve(tmp_path)


class FullDisk:
    """A file that takes some bytes and then no more."""

    def __init__(self, file, left):
        self.file, self.left = file, left

    def __getattr__(self, name):
        return getattr(self.file, name)

    def write(self, data):
        if not self.left:
            raise OSError(28, "No space left on device")
        written = self.file.write(data[: self.left])
        self.left -= written
        return written


def test_a_row_that_does_not_fit_on_the_disk_is_not_there_at_all(tmp_path):
    writer = CurveWriter(tmp_path / "curve.csv")
    first, second = (row(s, 1.0, 2.0) for s in steps([1.0, 2.0]))
    writer.write(first)
    before = (tmp_path / "curve.csv").read_bytes()
    writer._file = FullDisk(writer._file, 20)
    with pytest.raises(OSError, match="No space"):
        writer.write(second)
    assert (tmp_path / "curve.csv").read_bytes() == before
    writer._file.left = 10_000
    writer.write(second)
    writer.close()
    assert read_curve(tmp_path)["load_N"].tolist() == [1.0, 2.0]


def test_a_curve_that_goes_on_is_written_as_at_first(tmp_path):
    rows = [row(s, 1.0 / 3.0, 2.0) for s in steps([1.0, 2.0, 1.0 / 3.0])]
    names = tuple(rows[0])
    for file, split in (("one.csv", 0), ("other.csv", 2)):
        begun = columns(rows[:split]) if split else None
        writer = CurveWriter(tmp_path / file, names, begun)
        for values in rows[split:]:
            writer.write(values)
        writer.close()
    assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "other.csv").read_bytes()
