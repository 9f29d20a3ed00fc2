"""Tests of reading tables of measurements. Exported files of ten programs must be read with their units.

An error message must name the line and the column of the error.
"""

import numpy as np
import pytest
from softcradle.sandbox.measured_table import read_table
from softcradle.sandbox.user_error import UserError

TRACKER = """mass_A
t\tx\ty\tv_{x}\tv
0,000000E0\t1,0E-2\t5,0E-1\t\t
3,333333E-2\t4,0E-2\t5,0E-1\t9,0E-1\t9,1E-1
6,666667E-2\t7,0E-2\t5,0E-1\t\t
"""
TRACKER_MULTI = """#multi:
,cart_A,,cart_B,
t,x,v_{x},x,v_{x}
0.0,0.10,,0.50,
0.1,0.15,0.5,0.50,0.0
0.2,0.20,,0.51,
"""
PHYPHOX = """"Time (s)","Acceleration x (m/s^2)","Acceleration y (m/s^2)","Absolute acceleration (m/s^2)"
0.000000000E0,1.5E-1,9.81E0,9.82E0
1.000000000E-2,2.5E-1,9.81E0,9.82E0
"""
PHYPHOX_GERMAN = """"Zeit (s)";"Geschwindigkeit (m/s)"
0,000000000E0;5,000000000E-1
1,000000000E-2;NaN
2,000000000E-2;4,5E-1
"""
QUALISYS = """FILE_VERSION\t2.0.0
NO_OF_FRAMES\t3
NO_OF_CAMERAS\t2
NO_OF_MARKERS\t2
FREQUENCY\t500
DESCRIPTION\t--
TIME_STAMP\t2025-01-01, 12:00:00.000\t1.5
DATA_INCLUDED\t3D
MARKER_NAMES\tglider 1\tglider 2
TRAJECTORY_TYPES\tMeasured\tMeasured
192.776\t457.598\t397.918\t484.367\t487.624\t399.075
192.754\t457.608\t397.806\t484.029\t487.716\t399.079
192.795\t457.601\t397.769\t483.798\t487.655\t399.087
"""
EXCEL_GERMAN = """Versuch 3: Stoß zweier Wagen
Datum: 3.5.2026

Zeit [ms];Ort Wagen 1 [cm];Ort Wagen 2 [cm];Kraft [kN]
0;10,5;50;0
20;11,5;#NV;1,25
40;12,5;50,5;0
"""
LOGGER_PRO = """Vernier Format 2
Untitled.cmbl 11/29/2026 10:00:00
Run 1
Time\tPosition\tVelocity
s\tm\tm/s

0\t0.25\t0.5
0.05\t0.275\t0.5
"""
CAPSTONE = """Time (s) Run #1,Position (m) Run #1,Velocity (m/s) Run #1,Acceleration (m/s²) Run #1
0.0,0.25,,
0.1,0.30,0.5,0.1
0.2,0.35,,
"""
PANDAS = """,time,v0,v1
0,0.0,1.0,0.0
1,0.5,,0.25
2,1.0,0.5,NaN
"""
SPREADSHEET_QUOTED = """"t / s","v_1 / (cm/s)","v_2 / (cm/s)"
"0,0","50,0","0,0"
"0,1","-","25,5"
"""
BLANKS = """ t (s)   F (N)
 0.0     0.0
 0.001   12.5
 0.002   -
"""
NAN = np.nan
# Expected contents for each format: the text, its encoding and the times [s]. Each column has its name, quantity, axis
# and values in SI units.
FORMATS = {
    "Tracker": (TRACKER, "utf-8", [0, 0.03333333, 0.06666667], [
        ("x", "position", "x", [0.01, 0.04, 0.07]), ("y", "position", "y", [0.5, 0.5, 0.5]),
        ("v_{x}", "velocity", "x", [NAN, 0.9, NAN]), ("v", "", "", [NAN, 0.91, NAN]),
    ]),
    "Tracker, two carts": (TRACKER_MULTI, "utf-8", [0, 0.1, 0.2], [
        ("cart_A x", "position", "x", [0.1, 0.15, 0.2]), ("cart_A v_{x}", "velocity", "x", [NAN, 0.5, NAN]),
        ("cart_B x", "position", "x", [0.5, 0.5, 0.51]), ("cart_B v_{x}", "velocity", "x", [NAN, 0.0, NAN]),
    ]),
    "phyphox": (PHYPHOX, "utf-8", [0, 0.01], [
        ("Acceleration x", "acceleration", "x", [0.15, 0.25]), ("Acceleration y", "acceleration", "y", [9.81, 9.81]),
        ("Absolute acceleration", "", "", [9.82, 9.82]),
    ]),
    "phyphox, German": (PHYPHOX_GERMAN, "utf-8-sig", [0, 0.01, 0.02], [
        ("Geschwindigkeit", "velocity", "", [0.5, NAN, 0.45]),
    ]),
    "Qualisys": (QUALISYS, "utf-8", [0, 0.002, 0.004], [
        ("glider 1 X", "position", "x", [0.192776, 0.192754, 0.192795]),
        ("glider 1 Y", "position", "y", [0.457598, 0.457608, 0.457601]),
        ("glider 1 Z", "position", "z", [0.397918, 0.397806, 0.397769]),
        ("glider 2 X", "position", "x", [0.484367, 0.484029, 0.483798]),
        ("glider 2 Y", "position", "y", [0.487624, 0.487716, 0.487655]),
        ("glider 2 Z", "position", "z", [0.399075, 0.399079, 0.399087]),
    ]),
    "Excel, German, Windows-1252": (EXCEL_GERMAN, "cp1252", [0, 0.02, 0.04], [
        ("Ort Wagen 1", "position", "", [0.105, 0.115, 0.125]), ("Ort Wagen 2", "position", "", [0.5, NAN, 0.505]),
        ("Kraft", "force", "", [0, 1250, 0]),
    ]),
    "Excel, Unicode text": (EXCEL_GERMAN.replace(";", "\t"), "utf-16", [0, 0.02, 0.04], [
        ("Ort Wagen 1", "position", "", [0.105, 0.115, 0.125]), ("Ort Wagen 2", "position", "", [0.5, NAN, 0.505]),
        ("Kraft", "force", "", [0, 1250, 0]),
    ]),
    "Notepad, UTF-16 without a mark": (LOGGER_PRO, "utf-16-le", [0, 0.05], [
        ("Position", "position", "", [0.25, 0.275]), ("Velocity", "velocity", "", [0.5, 0.5]),
    ]),
    "Logger Pro": (LOGGER_PRO, "utf-8", [0, 0.05], [
        ("Position", "position", "", [0.25, 0.275]), ("Velocity", "velocity", "", [0.5, 0.5]),
    ]),
    "Capstone": (CAPSTONE, "utf-8", [0, 0.1, 0.2], [
        ("Position Run #1", "position", "", [0.25, 0.3, 0.35]), ("Velocity Run #1", "velocity", "", [NAN, 0.5, NAN]),
        ("Acceleration Run #1", "acceleration", "", [NAN, 0.1, NAN]),
    ]),
    "pandas": (PANDAS, "utf-8", [0, 0.5, 1], [
        ("v0", "velocity", "", [1, NAN, 0.5]), ("v1", "velocity", "", [0, 0.25, NAN]),
    ]),
    "quoted decimal commas": (SPREADSHEET_QUOTED, "utf-8", [0, 0.1], [
        ("v_1", "velocity", "", [0.5, NAN]), ("v_2", "velocity", "", [0, 0.255]),
    ]),
    "blanks": (BLANKS, "utf-8", [0, 0.001, 0.002], [("F", "force", "", [0, 12.5, NAN])]),
}  # fmt: skip


@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize(("text", "encoding", "time", "columns"), FORMATS.values(), ids=FORMATS)
def test_export_is_read_in_si_units(text, encoding, time, columns, ends, tmp_path):
    path = tmp_path / "track.csv"
    path.write_bytes(text.replace("\n", ends).encode(encoding))
    table = read_table(path)
    np.testing.assert_allclose(table.time, time, rtol=1e-12)
    assert [(one.name, one.quantity, one.axis) for one in table.columns] == [column[:3] for column in columns]
    for one, (*_, values) in zip(table.columns, columns, strict=True):
        np.testing.assert_allclose(one.values, values, rtol=1e-12)


def test_only_columns_along_the_row_are_laid_over_plots(tmp_path):
    (tmp_path / "track.txt").write_text(TRACKER)
    table = read_table(tmp_path / "track.txt")
    assert [one.name for one in table.along_row("position")] == ["x"]
    assert [one.name for one in table.along_row("velocity")] == ["v_{x}"]
    assert table.quantities == ("position", "velocity")


def test_table_of_a_run_is_read_back(tmp_path):
    from softcradle.physics import Chain, power_law, simulate

    run = simulate(Chain([1.0] * 3, power_law(1.0, 0.1)), [1.0, 0.0, 0.0], samples=20)
    run.to_csv(tmp_path / "run.csv")
    table = read_table(tmp_path / "run.csv")
    np.testing.assert_array_equal(table.time, run.time)
    np.testing.assert_array_equal(np.column_stack([one.values for one in table.along_row("velocity")]), run.velocity)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "line 1, column 1: no numbers below a line of names"),
        ("t,v\n0,1\n", "line 2, column 1: a table needs at least two lines of numbers"),
        ("0,1\n1,2\n2,3\n", "line 1, column 1: the numbers need a line of names above them, such as t (s), v1 (m/s)"),
        ("t,v\n\n0,1\n0,2\n", "line 4, column 1: the times must increase, but 0 s follows 0 s; export one run"),
        ("\nt,v\n0,1\n\n1,fast\n", "line 5, column 2: 'v' is 'fast', not a finite number; leave the cell empty"),
        ("t,v\n0,1\n1,inf\n2,3\n", "line 3, column 2: 'v' is 'inf', not a finite number"),
        ("t,v\n0,1\n,2\n", "line 3, column 1: 't' is empty, but the line has numbers"),
        ("t,v\n0,1\n1,2,3\n", "line 3, column 3: the line has 3 cells, but line 1 has 2 names"),
        ("t;v\n0,0;1,5\n1,0;2,5\n2,0;3.5\n", "line 4, column 2: 'v' is '3.5', but other numbers have the decimal mark ','"),
        ('t,v\n0,1\n1,"2\n', "line 3, column 2: 'v' is '\"2', not a finite number"),
        ("v0,v1\n0,1\n1,2\n", "line 1, column 1: no column is a time; name one t (s)"),
        ("t (s),x (m),t (s),x (m)\n0,1,0,1\n1,2,1,2\n", "line 1, column 3: 't' and 't' are both times; export one run"),
        ("t,v (m)\n0,1\n1,2\n", "line 1, column 2: 'v (m)' means velocity by its name, but position by its unit; rename it"),
        ("t,v (ell/s)\n0,1\n1,2\n", "line 1, column 2: 'v (ell/s)' has the unknown unit 'ell/s'; known are s, "),
        ("t,x1 (mm),x2\n0,1,1\n1,2,2\n", "line 1, column 3: 'x2' needs a unit because 'x1' is in mm"),
        ("t,frame\n0,1\n1,2\n", "line 1, column 1: the time is the only column"),
    ],
)  # fmt: skip
def test_unclear_table_is_refused_at_its_place(text, sentence, tmp_path):
    path = tmp_path / "track.csv"
    path.write_text(text)
    with pytest.raises(UserError) as refused:
        read_table(path)
    assert str(refused.value).startswith(f"{path}, {sentence}")


def test_unknown_names_have_no_quantity(tmp_path):
    (tmp_path / "track.csv").write_text("t,cart A,temperature (°C)\n0,1,20\n1,2,20\n")
    assert [one.quantity for one in read_table(tmp_path / "track.csv").columns] == ["", ""]


def test_file_that_cannot_be_read_is_refused(tmp_path):
    with pytest.raises(UserError, match="cannot read"):
        read_table(tmp_path / "none.csv")
    (tmp_path / "film.csv").write_bytes(b"\0\0\0\xff\xd8")
    with pytest.raises(UserError, match="line 1, column 1: "):
        read_table(tmp_path / "film.csv")
