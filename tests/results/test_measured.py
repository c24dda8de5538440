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


@pytest.mark.parametrize(
    ("content", "options"),
    [
        ("CMOD [mm];load [kN]\n0,001;0,09\n0,003;0,2\n", {}),
        ("load (N),opening (um)\n90,1\n200,3\n", {}),
        ("# cmod_um\tload_N\n1\t90\n3\t200\n", {}),
        ("CMOD;load\nmm;kN\n0,001;0,09\n0,003;0,2\n", {}),
        ("CMOD / mm, load in kN\n0.001,0.09\n0.003,0.2\n", {}),
        ("0.001,0.09\n0.003,0.2\n", {"units": ["mm", "kN"]}),
        ("time [s],CMOD [mm],load [N]\n0,0.001,90\n1,0.003,200\n", {"columns": ["CMOD", "load [N]"]}),
        ("step,gauge_m,load_N,control\n1,1e-6,90,gauge\n2,3e-6,200,gauge\n", {}),
    ],
)
def test_curves_with_units(tmp_path, content, options):
    path = tmp_path / "curve.csv"
    path.write_text("\ufeff" + content, encoding="utf-8")
    band = read_measured(path, plain=False, **options)
    np.testing.assert_allclose(band.gauge, [1e-6, 3e-6], rtol=1e-14)
    np.testing.assert_allclose(band.lower, [90, 200], rtol=1e-14)
    assert band.is_curve
    assert band.back == 0.0


def test_bands_with_units_and_how_far_the_gauge_turns_back(tmp_path):
    path = tmp_path / "band.csv"
    path.write_text("largest [kN];CMOD [mm];smallest [kN]\n0,3;0,003;0,2\n0,11;0,001;0,09\n")
    band = read_measured(path)
    np.testing.assert_allclose(band.lower, [90, 200])
    np.testing.assert_allclose(band.upper, [110, 300])
    assert band.back == pytest.approx(2e-6)


@pytest.mark.parametrize(
    ("content", "options", "message"),
    [
        ("1,2\n3,4\n", {}, "has no units"),
        ("CMOD,load [N]\n1,2\n", {}, '"CMOD" has no unit'),
        ("CMOD [mm],load [MPa]\n1,2\n", {}, r'"load \[MPa\]" has no unit'),
        ("CMOD [mm],gauge [mm]\n1,2\n", {}, "2 columns of lengths"),
        ("1,2\n", {"units": ["mm", "s"]}, '"s" is no unit'),
        ("1,2\n", {"units": ["mm"]}, "1 units are told for 2 columns"),
        ("a [mm],b [N],c [N],d [N]\n1,2,3,4\n", {}, "has 4 columns"),
        ("a [mm],b [N]\n1,2\n", {"columns": ["a", "x"]}, 'no column "x"'),
        ("a [mm],b [N],c [N]\n1,2,3\n2,3,1\n", {}, "is above"),
    ],
)
def test_what_is_no_curve(tmp_path, content, options, message):
    path = tmp_path / "curve.csv"
    path.write_text(content)
    with pytest.raises(InputError, match=message) as caught:
        read_measured(path, key="here", plain=False, **options)
    assert caught.value.key == "here"
    assert caught.value.allowed
