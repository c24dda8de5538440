import numpy as np
import pytest

from fissura.errors import InputError
from fissura.results.measured import read_measured


def test_columns_in_si(tmp_path):
    path = tmp_path / "band.csv"
    path.write_text("# cmod_mm,min_N,max_N\n0.003,200,300\n\n0.001,90,110\n")
    band = read_measured(path)
    np.testing.assert_allclose(band.gauge, [1e-6, 3e-6])
    np.testing.assert_allclose(band.lower, [90, 200])
    np.testing.assert_allclose(band.upper, [110, 300])


@pytest.mark.parametrize(
    ("content", "message"),
    [("# nothing\n", "holds no numbers"), ("1,2\n", "line 1"), ("# a\n1,2,x\n", "line 2")],
)
def test_broken_files(tmp_path, content, message):
    path = tmp_path / "band.csv"
    path.write_text(content)
    with pytest.raises(InputError, match=message) as caught:
        read_measured(path)
    assert caught.value.key == "output.measured"


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_measured(tmp_path / "none.csv")


@pytest.mark.parametrize(
    "content",
    [
        "0.001,90,110\n0.003,200,300\n",
        "cmod_mm,min_N,max_N\n0.001,90,110\n0.003,200,300\n",
        "0.001;90;110\n0.003;200;300\n",
        "0,001;90,0;110\n0,003;2e2;300,\n",
        "# opening; smallest, largest\ncmod_mm; min_N; max_N\r\n\r\n0,001; 90; 110\r\n0,003; 200; 300",
        '"0,001"\t"90"\t"110"\n"0,003"\t"200"\t"300"\n',
        '"0.001","90","110"\n 0.003 , +200 , .3e3 \n',
    ],
)
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_as_spreadsheets_write_them(tmp_path, content, mark):
    path = tmp_path / "band.csv"
    path.write_text(mark + content, encoding="utf-8", newline="")
    band = read_measured(path)
    np.testing.assert_allclose(band.gauge, [1e-6, 3e-6], rtol=1e-15)
    np.testing.assert_allclose(band.lower, [90, 200])
    np.testing.assert_allclose(band.upper, [110, 300])


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("0,001,90,0,110,0", "line 2 .* has 6 values, .*: decimal commas need semicolons or tabs"),
        ("0.001 90 110", "line 2 .* has 1 value"),
        ('"1,200",2,3', 'cmod_mm is "1,200", not a number'),
        ("1;1.234,5;2", 'min_N is "1.234,5", not a number'),
        ("1;2", "has 2 values"),
        ("1,nan,2", 'min_N is "nan", not finite'),
        ("1,2,Inf", 'max_N is "Inf", not finite'),
        ("-inf,1,2", 'cmod_mm is "-inf", not finite'),
        ("1,3,2", "min_N = 3 is above max_N = 2"),
        ("1,2,1e16", 'max_N = "1e16" is too large'),
        ("1e400,2,3", 'cmod_mm = "1e400" is too large'),
        ("1,2_0,30", 'min_N is "2_0", not a number'),
        ("1,,3", 'min_N is "", not a number'),
        ("1,\x002,3", "min_N is .*, not a number"),
        ("1,2,3,4", "has 4 values"),
        ("cmod_mm,min_N,max_N", 'cmod_mm is "cmod_mm", not a number'),
        ("1,2," + "3" * 200_000, "line 2"),
    ],
)
def test_what_is_no_band(tmp_path, line, message):
    path = tmp_path / "band.csv"
    path.write_text(f"{'0.001;90;110' if ';' in line else '0.001,90,110'}\n{line}\n")
    with pytest.raises(InputError, match=message) as caught:
        read_measured(path)
    assert caught.value.key == "output.measured"
    assert len(str(caught.value)) < 500


def test_other_encodings_are_told(tmp_path):
    path = tmp_path / "band.csv"
    path.write_text("0.001,90,110\n", encoding="utf-16")
    with pytest.raises(InputError, match=r"band\.csv is UTF-16 text .*save it as UTF-8"):
        read_measured(path)
    path.write_bytes(b"# \xe4\n0.001,90,110\n")
    with pytest.raises(InputError, match=r"band\.csv is not UTF-8 text \(byte 2\)"):
        read_measured(path)
